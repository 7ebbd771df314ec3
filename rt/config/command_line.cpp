#include "rt/config/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>

namespace palpate::config {
namespace {

/// Without the deprecated positional arguments, which CLI11 would list under "Usage:".
class UsageFormatter : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = CLI::Formatter::make_usage(app, std::move(name));
    const auto is_hidden = [](const CLI::Option* option) {
      return option->get_positional() && option->get_group().empty();
    };
    for (const CLI::Option* option : app->get_options(is_hidden)) {
      const std::string text = " " + make_option_usage(option);
      const std::size_t at = usage.find(text);
      if (at != std::string::npos) usage.erase(at, text.size());
    }
    return usage;
  }
};

void warn_deprecated(const std::string& old_name, const std::string& name) {
  std::fprintf(stderr, "warning: %s is deprecated; use %s\n", old_name.c_str(), name.c_str());
}

std::string exit_code_table(const std::vector<ExitCode>& own) {
  std::map<int, std::string> codes = {
      {kExitDone, "done"}, {kExitError, "an error"}, {kExitUsage, "wrong command line"}};
  for (const ExitCode& one : own) codes[one.code] = one.meaning;
  const std::string head = "Exit codes: ";
  std::string table;
  for (const auto& [code, meaning] : codes) {
    std::string number = std::to_string(code);
    number.resize(4, ' ');
    table += (table.empty() ? head : "\n" + std::string(head.size(), ' ')) + number + meaning;
  }
  return table;
}

void add_to_footers(CLI::App& app, const std::string& table) {
  const std::string footer = app.get_footer();
  app.footer(footer.empty() ? table : footer + "\n" + table);
  for (CLI::App* command : app.get_subcommands({})) add_to_footers(*command, table);
}

/// The arguments with today's names of options.
std::vector<std::string> with_new_names(int argc, const char* const* argv,
                                        const std::vector<RenamedOption>& renamed) {
  std::vector<std::string> words(argv, argv + argc);
  for (std::size_t i = 1; i < words.size() && words[i] != "--"; ++i) {
    const std::size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    const auto found = std::find_if(renamed.begin(), renamed.end(),
                                    [&](const RenamedOption& one) { return one.old_name == name; });
    if (found == renamed.end()) continue;
    warn_deprecated(name, found->name + (found->prefix.empty() ? "" : " " + found->prefix + "..."));
    if (equals != std::string::npos) {
      words[i] = found->name + "=" + found->prefix + words[i].substr(equals + 1);
    } else {
      words[i] = found->name;
      if (!found->prefix.empty() && i + 1 < words.size()) words[++i].insert(0, found->prefix);
    }
  }
  return words;
}

}  // namespace

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv,
                         const CommandLine& line) {
  if (app.get_version_ptr() == nullptr) app.set_version_flag("--version", PALPATE_VERSION);
  add_to_footers(app, exit_code_table(line.exit_codes));
  const std::vector<std::string> words = with_new_names(argc, argv, line.renamed);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  try {
    app.parse(argc, pointers.data());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  return std::nullopt;
}

int usage_error(const CLI::App& app, const std::string& message) {
  app.exit(CLI::ValidationError(message));
  return kExitUsage;
}

void add_deprecated_positional(CLI::App& app, const std::string& name, std::string& value,
                               const std::string& option) {
  const auto set = [&value, name, option](const std::string& text) {
    if (!value.empty())
      throw CLI::ValidationError("'" + text + "' is given in addition to " + option);
    warn_deprecated("the positional argument " + name, option);
    value = text;
  };
  app.add_option_function<std::string>(name, set)->group("");
  app.formatter(std::make_shared<UsageFormatter>());
}

LabelledUrl labelled_url(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text.find("://") < equals) return {"control", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void add_url_option(CLI::App& app, const std::vector<std::pair<std::string, std::string*>>& urls) {
  std::string labels, defaults;
  for (const auto& [label, url] : urls) {
    labels += (labels.empty() ? "" : ", ") + label;
    if (!url->empty()) defaults += (defaults.empty() ? "" : ", ") + label + "=" + *url;
  }
  const auto set = [urls, labels](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const LabelledUrl given = labelled_url(text);
      const auto found = std::find_if(urls.begin(), urls.end(),
                                      [&](const auto& one) { return one.first == given.label; });
      if (found == urls.end())
        throw CLI::ValidationError("--url",
                                   "'" + given.label + "' is none of the labels " + labels);
      *found->second = given.url;
    }
  };
  app.add_option_function<std::vector<std::string>>(
         "--url", set,
         "LCM URL of a label: " + labels + " (repeatable; without a label: control)" +
             (defaults.empty() ? "" : ". Default: " + defaults))
      ->type_name("[LABEL=]URL")
      ->allow_extra_args(false);
}

}  // namespace palpate::config
