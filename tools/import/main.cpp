#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>

#include "rt/config/command_line.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/import/fields.hpp"
#include "tools/import/import_csv.hpp"

namespace {

/// "key=value" pairs; throws std::invalid_argument naming the option.
std::map<std::string, std::string> pairs(const std::vector<std::string>& texts,
                                         const std::string& option) {
  std::map<std::string, std::string> result;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw std::invalid_argument(option + " '" + text + "' must read NAME=VALUE");
    result[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return result;
}

void write_json(const std::string& file, const palpate::import::ImportOptions& options,
                const palpate::import::ImportSummary& summary) {
  const nlohmann::json json = {{"input", options.input},
                               {"output", options.output},
                               {"session", options.session},
                               {"rows", summary.rows},
                               {"first_utime", summary.first_utime},
                               {"last_utime", summary.last_utime},
                               {"messages", summary.messages}};
  palpate::common::write_json(json, file);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate;
  import::ImportOptions options;
  import::Stream stream;
  std::string preset, map_file, json_file;
  std::vector<std::string> columns, where;

  CLI::App app("Turns a CSV recording, plain or .gz, into an LCM log.");
  app.footer(
      "Example:\n"
      "  palpate-import wrist.csv --format force_torque --channel FT_WRENCH -o wrist.log");
  app.add_option("csv", options.input, "Recording with a header line")->required();
  app.add_option("-o,--output", options.output, "LCM log to write")->required();
  auto* const preset_option =
      app.add_option("--preset", preset, "Recording whose columns are known")
          ->check(CLI::IsMember(import::preset_names()));
  auto* const map_option =
      app.add_option("--map", map_file, "YAML: streams of {channel, format, columns}");
  auto* const format_option =
      app.add_option("--format", stream.format, "Message type; --formats lists their fields")
          ->check(CLI::IsMember(import::format_names()));
  auto* const channel_option =
      app.add_option("--channel", stream.channel, "LCM channel of --format");
  app.add_option("--column", columns,
                 "FIELD=[-]COLUMN[:UNIT] or FIELD==CONSTANT; fields without one take the column of "
                 "their name, in SI")
      ->needs(format_option);
  format_option->needs(channel_option)->excludes(preset_option)->excludes(map_option);
  channel_option->needs(format_option);
  preset_option->excludes(map_option);
  std::string delimiter = "auto";
  auto* const delimiter_option =
      app.add_option("--delimiter", delimiter, "Between cells; auto: found from the header line")
          ->check(CLI::IsMember({"auto", "comma", "semicolon", "tab"}))
          ->capture_default_str();
  app.add_option("--time-column", options.time_column, "Column of the time")->capture_default_str();
  app.add_option("--time-unit", options.time_unit, "Its unit")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}))
      ->capture_default_str();
  app.add_option("--rate", options.rate, "Rows per second, for a file without times")
      ->check(CLI::PositiveNumber);
  app.add_option("--start", options.start, "Seconds added to every time");
  app.add_option("--where", where, "COLUMN=TEXT: only rows that read so");
  auto* const session_option =
      app.add_option("--session", options.session, "Session of the messages (default: random)");
  app.add_option("--json", json_file, "Write a summary");
  app.add_flag_callback(
      "--formats",
      [] {
        std::string page = import::formats_page();
        page.pop_back();  // CLI11 ends the line
        throw CLI::CallForVersion(page, 0);
      },
      "Print the fields of each --format with unit and effect, and whether it is required");
  if (const auto code = config::parse(app, argc, argv, {{{78, "wrong map"}}})) return *code;

  return common::run_program("palpate-import", [&] {
    options.where = pairs(where, "--where");
    if (!preset.empty()) {
      options.streams = import::preset_streams(preset);
    } else if (!map_file.empty()) {
      import::read_map(config::Node::load_file(map_file), options);
    } else if (!stream.format.empty()) {
      stream.columns = pairs(columns, "--column");
      options.streams = {stream};
    } else {
      throw std::invalid_argument("one of --preset, --map, --format is needed");
    }
    if (delimiter_option->count() > 0) options.delimiter = import::delimiter_of(delimiter);
    if (session_option->count() == 0) {
      std::random_device device;
      options.session = static_cast<std::int64_t>(device()) << 31 | device();
    }
    const import::ImportSummary summary = import::import_csv(options);
    std::cout << options.output << ": " << summary.rows << " rows over "
              << 1e-6 * static_cast<double>(summary.last_utime - summary.first_utime) << " s\n";
    for (const auto& [channel, count] : summary.messages)
      std::cout << "  " << channel << ": " << count << " messages\n";
    if (!json_file.empty()) write_json(json_file, options, summary);
    return 0;
  });
}
