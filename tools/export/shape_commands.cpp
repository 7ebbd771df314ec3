#include <memory>

#include "tools/export/commands.hpp"
#include "tools/export/options.hpp"
#include "tools/export/shape_options.hpp"
#include "tools/export/vtu_export.hpp"

namespace palpate::exporting {

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

}  // namespace palpate::exporting
