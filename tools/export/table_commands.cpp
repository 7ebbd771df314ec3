#include <iostream>
#include <memory>

#include "tools/export/commands.hpp"
#include "tools/export/csv_export.hpp"
#include "tools/export/info.hpp"
#include "tools/export/options.hpp"
#include "tools/export/output_file.hpp"

namespace palpate::exporting {

void add_info(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "info",
      "Channels, types, rates, losses by sequence number, sessions, times, damage, strangers");
  struct Options {
    SourceOptions source;
    std::string json;
    bool fields = false;
  };
  const auto options = std::make_shared<Options>();
  command->add_option("logs", options->source.logs, "LCM logs")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_flag("--fields", options->fields, "Every field with its size, unit and meaning");
  command->add_option("--json", options->json, "Write the same for programs");
  command->add_flag("--quiet", options->source.quiet, "No progress");
  command->callback([options, &chosen] {
    chosen = [options] {
      const Source source(options->source);
      if (options->fields)
        print_fields(source.found(), std::cout);
      else
        print_info(source.found(), std::cout);
      if (options->json.empty()) return;
      OutputFile out(options->json);
      out.write(info_json(source.found()).dump(2) + "\n");
      out.finish();
    };
  });
}

void add_csv(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "csv",
      "One CSV file a channel, arrays as columns, and what each column means, with its unit, in\n"
      "CHANNEL.columns.csv beside it. Column 'time' is in s since the earliest message of all "
      "logs\n"
      "(see --clock), 'received_utime' in us when the log received the message, 'utime' in us the\n"
      "clock of its sender. Cells of arrays beyond what a message uses are empty.");
  struct Options {
    SourceOptions source;
    std::string output;
  };
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  add_channels(*command, options->source);
  command->add_option("-o,--output", options->output, "Folder to write to")->required();
  command->callback([options, &chosen] {
    chosen = [options] {
      Source source(options->source);
      report(export_csv(source, options->output), source);
    };
  });
}

}  // namespace palpate::exporting
