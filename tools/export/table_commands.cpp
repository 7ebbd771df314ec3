#include <iostream>
#include <memory>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "tools/export/commands.hpp"
#include "tools/export/csv_export.hpp"
#include "tools/export/mcap_export.hpp"
#include "tools/export/output_file.hpp"
#include "tools/export/plot_export.hpp"
#include "tools/export/survey.hpp"

namespace palpate::exporting {

void add_mcap(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "mcap",
      "One MCAP file of JSON messages with their schemas, indexed and checksummed, for Foxglove,\n"
      "PlotJuggler and the mcap libraries. log_time goes by --clock, publish_time is the utime of "
      "the\n"
      "sender. Entries of arrays of two dimensions are objects: CONTACTS.wrench[0].values[2].\n"
      "For Foxglove's 3-D view there are also /shape/estimate and /shape/truth (fixed frame O), "
      "and\n"
      "/flange, /tf and a point cloud for each camera (frame W).");
  struct Options {
    SourceOptions source;
    McapOptions mcap;
    std::string configuration, output;
  };
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  add_channels(*command, options->source);
  command->add_option("--compression", options->mcap.compression, "none, lz4 or zstd")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, Compression>{{"none", Compression::kNone},
                                                                     {"lz4", Compression::kLz4},
                                                                     {"zstd", Compression::kZstd}})
              .description(""))
      ->type_name("KIND")
      ->default_str("zstd");
  command
      ->add_option("--scene-rate", options->mcap.scene_rate,
                   "Hz of what is added for 3-D views; 0: nothing is")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command
      ->add_option("--config", options->configuration,
                   "Configuration of palpated: says where the object is, so that arm and object "
                   "share a frame")
      ->check(CLI::ExistingFile);
  command->add_flag("--protobuf", options->mcap.protobuf,
                    "what is added for 3-D views in Protobuf in place of JSON, which Rerun "
                    "reads");
  command->add_option("-o,--output", options->output, "File to write, .mcap")->required();
  command->callback([options, &chosen] {
    chosen = [options] {
      if (!options->configuration.empty())
        options->mcap.X_WO =
            registry::read_frames(config::Node::load_file(options->configuration)).X_WO;
      Source source(options->source);
      report(export_mcap(source, options->mcap, options->output), source);
    };
  });
}

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
  types::add_types_option(*command, options->source.types);
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
      "CHANNEL.columns.csv next to it. Column 'time' is in s since the earliest message of all "
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

void add_plot(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "plot",
      "Fields of any channel over time, to PNG or SVG by matplotlib; one panel for each --field:\n"
      "  CHANNEL.field            all its numbers\n"
      "  CHANNEL.field[2]         one of them, or a row of an array of two dimensions\n"
      "  CHANNEL.field[0][0:3]    a range, the end left out\n"
      "  norm(CHANNEL.field)      the length of the vector that they make\n"
      "Several in one panel have commas between them: 'FEATURE.value[2],FEATURE.target[2]'.\n"
      "Peaks are kept, however many messages there are.");
  struct Options {
    SourceOptions source;
    std::vector<std::string> panels;
    std::string output;
    bool list = false;
  };
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  auto* const fields =
      command->add_option("--field", options->panels, "What a panel shows")->type_name("PATH ...");
  auto* const output = command->add_option("-o,--output", options->output, "File, .png or .svg");
  auto* const list =
      command->add_flag("--list", options->list, "Only list channels and fields with their units");
  fields->needs(output)->excludes(list);
  output->needs(fields);
  command->callback([options, &chosen] {
    chosen = [options] {
      if (!options->list && options->panels.empty())
        throw std::runtime_error("plot wants --field with --output, or --list");
      Source source(options->source);
      if (options->list) {
        print_fields(source.found(), std::cout);
        return;
      }
      const int curves = export_plot(source, options->panels, options->output);
      report({{options->output, "curves", curves}}, source);
    };
  });
}

}  // namespace palpate::exporting
