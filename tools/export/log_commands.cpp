#include <iostream>
#include <memory>

#include "tools/export/commands.hpp"
#include "tools/export/log_export.hpp"

namespace palpate::exporting {
namespace {

struct LogOptions {
  LogSelection selection;
  std::string output;
};

/// `check` throws CLI::Error for options that do not go together.
CLI::App& add_log_command(CLI::App& app, std::function<void()>& chosen, const std::string& name,
                          const std::string& description,
                          const std::shared_ptr<LogOptions>& options,
                          const std::function<void()>& check) {
  CLI::App* const command = app.add_subcommand(name, description);
  command->add_option("logs", options->selection.logs, "LCM logs; several are merged by time")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("-o,--output", options->output, "LCM log to write")->required();
  command->add_flag("--quiet", options->selection.quiet, "No progress");
  command->callback([options, &chosen, check] {
    check();
    chosen = [options] {
      const Written written = export_log(options->selection, options->output);
      std::cout << written.file.string() << ": " << written.count << ' ' << written.what << '\n';
    };
  });
  return *command;
}

}  // namespace

void add_merge(CLI::App& app, std::function<void()>& chosen) {
  add_log_command(app, chosen, "merge",
                  "Several logs to one, ordered by the time of reception: those of the URLs of a "
                  "run, or the\n"
                  "pieces of a rotated log. Events of all types are kept as they are.",
                  std::make_shared<LogOptions>(), [] {});
}

void add_cut(CLI::App& app, std::function<void()>& chosen) {
  const auto options = std::make_shared<LogOptions>();
  CLI::App& command =
      add_log_command(app, chosen, "cut", "A part of the time of one or several logs, to one log.",
                      options, [options] {
                        const LogSelection& selection = options->selection;
                        if (!(selection.from <= selection.to))
                          throw CLI::ValidationError("--from", "must not be later than --to");
                      });
  command.add_option("--from", options->selection.from,
                     "s since the first event; what is earlier is left out");
  command.add_option("--to", options->selection.to,
                     "s since the first event; what is later is left out");
}

void add_filter(CLI::App& app, std::function<void()>& chosen) {
  const auto options = std::make_shared<LogOptions>();
  CLI::App& command = add_log_command(
      app, chosen, "filter", "Some channels of one or several logs, to one log.", options,
      [options] {
        if (options->selection.channels.empty() && options->selection.without.empty())
          throw CLI::RequiredError("--channel or --without");
      });
  command
      .add_option("--channel", options->selection.channels,
                  "Only these channels; patterns as 'BIOTAC_*'")
      ->type_name("NAME ...");
  command
      .add_option("--without", options->selection.without,
                  "All channels, or those of --channel, but these; patterns as 'BIOTAC_*'")
      ->type_name("NAME ...");
}

}  // namespace palpate::exporting
