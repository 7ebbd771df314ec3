// palpate-mesh: makes, converts, checks and repairs meshes of tetrahedra. See --help.

#include <CLI/CLI.hpp>
#include <iostream>

#include "tools/common/interruption.hpp"
#include "tools/common/program.hpp"
#include "tools/mesh/commands.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app(
      "palpate-mesh makes meshes of tetrahedra for palpated: boxes, cylinders, ellipsoids and the\n"
      "inside of surfaces; it converts, checks and repairs others', and names their parts. Lengths "
      "are m.");
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  palpate-mesh box bar.msh --size 0.5 0.06 0.06 --cells 10 1 1\n"
      "  palpate-mesh cylinder rod.msh --radius 0.025 --length 0.2 --edge 0.0125 --cost\n"
      "  palpate-mesh ellipsoid egg.vtu --half-axes 0.05 0.03 0.03 --edge 0.012 --order 2\n"
      "  palpate-mesh surface toy.stl toy.msh --scale mm --edge 0.01 --histograms toy.png\n"
      "  palpate-mesh scan cloud.ply toy.msh --nodes 700 --deviation toy.png\n"
      "  palpate-mesh check toy.msh --picture toy.faults.png --json -\n"
      "  palpate-mesh repair old.veg new.msh --largest-part\n"
      "  palpate-mesh convert bar.msh bar.node --first 0\n"
      "  palpate-mesh regions bar.msh --group clamp --box 0 0 0 0.05 1 1 --output bar.msh\n"
      "In a configuration of palpated: object: {mesh: {file: bar.msh}, ...}\n"
      "Each command has its own --help.");
  int code = mesh_tool::kGood;
  mesh_tool::add_make_commands(app, code);
  mesh_tool::add_scan_command(app, code);
  mesh_tool::add_file_commands(app, code);
  mesh_tool::add_region_command(app, code);
  common::catch_interruptions();
  return common::run_program("palpate-mesh", [&]() -> int {
    if (const auto ended = config::parse(app, argc, argv,
                                         {{{mesh_tool::kGood, "done, and the mesh is good"},
                                           {mesh_tool::kFailed, "an error of a file or program"},
                                           {mesh_tool::kBroken, "the mesh is broken"},
                                           {config::kExitInterrupted, "interrupted"}}}))
      return *ended;
    return code;
  });
}
