#include <memory>

#include "tools/export/commands.hpp"
#include "tools/export/picture_export.hpp"
#include "tools/export/vtu_export.hpp"

namespace palpate::exporting {
namespace {

struct Options {
  SourceOptions source;
  FollowerOptions follower;
  DrawingOptions drawing;
  FilmOptions film;
  std::vector<double> times;
  std::vector<double> range;
  std::string output;
};

void add_drawing(CLI::App& command, Options& options) {
  DrawingOptions& drawing = options.drawing;
  command
      .add_option(
          "--colour,--color", drawing.quantity,
          "What colours show: displacement from rest, deviation from the truth, uncertainty "
          "(standard deviation), equivalent strain, von Mises stress, or none")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, Quantity>{{"none", Quantity::kNone},
                                                      {"displacement", Quantity::kDisplacement},
                                                      {"deviation", Quantity::kDeviation},
                                                      {"uncertainty", Quantity::kUncertainty},
                                                      {"strain", Quantity::kStrain},
                                                      {"stress", Quantity::kStress}})
                      .description(""))
      ->type_name("QUANTITY")
      ->default_str("displacement");
  command
      .add_option("--range", options.range,
                  "Ends of the colour scale in SI units (default: 0 and the largest value drawn)")
      ->expected(2)
      ->allow_extra_args(false)
      ->type_name("LOW HIGH");
  command.add_option("--azimuth", drawing.azimuth, "deg about z, from +x: where the camera stands")
      ->capture_default_str();
  command.add_option("--elevation", drawing.elevation, "deg above the horizon")
      ->check(CLI::Range(-90.0, 90.0))
      ->capture_default_str();
  command.add_option("--zoom", drawing.zoom, "2: everything twice as large")
      ->check(CLI::Range(0.05, 50.0))
      ->capture_default_str();
  command.add_option("--width", drawing.width, "px")
      ->check(CLI::Range(160, 7680))
      ->capture_default_str();
  command.add_option("--height", drawing.height, "px")
      ->check(CLI::Range(120, 4320))
      ->capture_default_str();
  command.add_option("--title", drawing.title, "Stands before the time");
  command
      .add_option(
          "--config", drawing.configuration,
          "Configuration of palpated: says where the object is in the arm's base W, so that "
          "z is up and arm and obstacles are drawn (default: drawn in the object's frame O)")
      ->check(CLI::ExistingFile);
  command.add_option("--urdf", drawing.urdf, "The arm, as primitive shapes")
      ->check(CLI::ExistingFile);
  add_stiffness(command, options.follower);
}

void finish(Options& options) {
  if (options.range.empty()) return;
  options.drawing.low = options.range[0];
  options.drawing.high = options.range[1];
  if (!(options.drawing.low < options.drawing.high))
    throw std::runtime_error("--range: LOW must be below HIGH");
}

}  // namespace

void add_vtu(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "vtu",
      "Shapes for ParaView: estimate.pvd, truth.pvd (where the log holds TRUTH_SHAPE) and\n"
      "forces.pvd, each a series of .vtu files over time. SI units, in the object's frame O.\n"
      "Nodes: displacement, deviation (estimate minus truth), standard_deviation, force, "
      "constrained.\n"
      "Elements: strain (Green-Lagrange, xx yy zz xy xz yz), equivalent_strain, stress (Cauchy),\n"
      "von_mises_stress. Stress and force need a stiffness: that of ESTIMATE, or --stiffness.");
  struct Options {
    SourceOptions source;
    FollowerOptions follower;
    std::string output;
    double rate = 10;
  };
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  add_stiffness(*command, options->follower);
  command->add_option("--rate", options->rate, "Shapes a second; 0: every one")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Folder to write to")->required();
  command->callback([options, &chosen] {
    chosen = [options] {
      Source source(options->source);
      ShapeFollower follower(source, options->follower);
      report(export_vtu(follower, options->rate, options->output), source);
    };
  });
}

void add_png(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "png",
      "Pictures of the shape, without a display: coloured by a quantity with its scale, the true\n"
      "shape as a wire over it where the log holds it, forces as arrows, feature and target.");
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  command->add_option("--at", options->times,
                      "s since the beginning of the logs; several make several pictures, with the "
                      "same scale and camera (default: the last shape that"
                      " has what --colour asks for)");
  add_drawing(*command, *options);
  command->add_option("-o,--output", options->output, "File to write, .png")->required();
  command->callback([options, &chosen] {
    chosen = [options] {
      finish(*options);
      Source source(options->source);
      ShapeFollower follower(source, options->follower);
      report(export_png(follower, options->drawing, options->times, options->output), source);
    };
  });
}

void add_mp4(CLI::App& app, std::function<void()>& chosen) {
  auto* const command = app.add_subcommand(
      "mp4", "A film of the shape over time, drawn as by png, encoded by ffmpeg (H.264).");
  const auto options = std::make_shared<Options>();
  add_source(*command, options->source);
  add_drawing(*command, *options);
  command->add_option("--fps", options->film.rate, "Pictures a second of the film")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  command->add_option("--speed", options->film.speed, "Seconds of the log in a second of the film")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "File to write, .mp4")->required();
  command->callback([options, &chosen] {
    chosen = [options] {
      finish(*options);
      Source source(options->source);
      ShapeFollower follower(source, options->follower);
      report(export_mp4(follower, options->drawing, options->film, options->output), source);
    };
  });
}

}  // namespace palpate::exporting
