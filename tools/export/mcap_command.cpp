#include <memory>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "tools/export/commands.hpp"
#include "tools/export/mcap_export.hpp"
#include "tools/export/options.hpp"

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

}  // namespace palpate::exporting
