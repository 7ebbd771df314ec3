#include "tools/reference/markdown.hpp"

#include <algorithm>
#include <iostream>
#include <ostream>

namespace palpate::reference {
namespace {

/// Escapes characters that would end a table cell.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : std::string(1, c);
  return safe;
}

std::string default_text(const Parameter& parameter) {
  std::string text;
  for (const std::string& value : parameter.defaults)
    text += (text.empty() ? "`" : " or `") + value + "`";
  if (!text.empty()) return text;
  return parameter.required ? "**required**" : "absent";
}

std::string condition_of(const Parameter& parameter) {
  std::string text;
  for (const auto& [choice, values] : parameter.only_with) {
    text += (text.empty() ? "" : "; ") + choice + " ";
    for (auto value = values.begin(); value != values.end(); ++value)
      text += (value == values.begin() ? "`" : ", `") + *value + "`";
  }
  return text.empty() ? "" : "(" + text + ") ";
}

/// Description of each alternative, if there is one.
void write_choices(std::ostream& out, const Parameter& parameter) {
  bool any = false;
  for (const auto& [name, description] : parameter.choices) {
    if (description.empty()) continue;
    if (!any) out << "`" << parameter.name << "`:\n\n";
    any = true;
    out << "- `" << name << "`: " << description << "\n";
  }
  if (any) out << "\n";
}

}  // namespace

void write_markdown(std::ostream& out, const std::vector<Section>& sections, int level) {
  for (const Section& section : sections) {
    out << std::string(static_cast<std::size_t>(level), '#') << " "
        << (section.path.empty() ? "Top level" : "`" + section.path + "`") << "\n\n"
        << "| key | type | unit | default | allowed | meaning |\n"
        << "| --- | --- | --- | --- | --- | --- |\n";
    for (const Parameter& parameter : section.parameters)
      out << "| `" << parameter.name << "` | " << parameter.type << " | " << parameter.unit << " | "
          << cell(default_text(parameter)) << " | " << cell(parameter.allowed) << " | "
          << cell(condition_of(parameter) + parameter.meaning) << " |\n";
    out << "\n";
    for (const Parameter& parameter : section.parameters) write_choices(out, parameter);
  }
}

bool write_tables(std::ostream& out, const std::vector<Declarations>& readings, int level) {
  const std::vector<Section> sections = merge(readings);
  write_markdown(out, sections, level);
  for (const std::string& name : undescribed(sections))
    std::cerr << "error: " << name << " is declared without a description\n";
  return undescribed(sections).empty();
}

}  // namespace palpate::reference
