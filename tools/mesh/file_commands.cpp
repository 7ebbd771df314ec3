#include <iostream>
#include <memory>

#include "core/mesh/node_motion.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/surface_repair.hpp"
#include "tools/mesh/commands.hpp"
#include "tools/mesh/options.hpp"
#include "tools/mesh/quality.hpp"

namespace palpate::mesh_tool {
namespace {

struct FileOptions {
  std::string input;
  double scale = 1;
  OutputOptions output;
  ReportOptions report;
  double merge_tolerance = 0;  // 0: the default of the format
  int largest_hole = 32;
  bool largest_part = false;
  int sweeps = 20;
};

int check_file(const FileOptions& options) {
  if (is_surface_file(options.input)) {
    const mesh::TriangleSurface surface = read_surface(options.input, options.scale);
    return report(surface, {options.input, {}, find_faults(surface)}, options.report);
  }
  const mesh::MeshWithGroups read = read_volume(options.input, options.scale);
  return report(read, {options.input, {}, find_faults(read)}, options.report);
}

/// A different convention for the order of corners alone is not a fault.
std::vector<mesh::RepairStep> orient_all(mesh::MeshWithGroups& read) {
  const mesh::MeshReport found = mesh::check(read.mesh);
  if (read.mesh.tetrahedron_count() == 0 ||
      static_cast<int>(found.negative_volume.size()) != read.mesh.tetrahedron_count())
    return {};
  mesh::orient(read.mesh);
  mesh::RepairStep step{"elements turned: the file's order of corners is the other one", {}};
  for (int t = 0; t < read.mesh.tetrahedron_count(); ++t)
    step.numbers.push_back(read.tetrahedron_number(t));
  return {step};
}

int convert_file(const FileOptions& options) {
  if (is_surface_file(options.input)) {
    const mesh::TriangleSurface surface = read_surface(options.input, options.scale);
    const Outcome outcome{options.input, {}, find_faults(surface)};
    if (!is_surface_file(options.output.file)) {
      throw std::runtime_error(options.input +
                               ": a surface has no tetrahedra; palpate-mesh surface makes them");
    }
    // Nonexistent items cannot be written; all other faults are kept.
    for (const Fault& fault : outcome.faults) {
      if (fault.kind == "out_of_range" || fault.kind == "not_finite" || fault.kind == "empty")
        return reject(surface, outcome, options.output, options.report);
    }
    write_surface(surface, options.output.file);
    return std::min(report(surface, outcome, options.report), kGood);
  }
  mesh::MeshWithGroups read = read_volume(options.input, options.scale);
  Outcome outcome{options.input, orient_all(read), {}};
  outcome.faults = find_faults(read);
  if (has_errors(outcome.faults)) {
    const int code = reject(read, outcome, options.output, options.report);
    std::cerr << "palpate-mesh repair corrects many of these\n";
    return code;
  }
  write_volume(read, options.output.file, options.output.format());
  return report(read, outcome, options.report);
}

int repair_surface(const FileOptions& options) {
  mesh::TriangleSurface surface = read_surface(options.input, options.scale);
  mesh::SurfaceRepairOptions repair;
  if (options.merge_tolerance > 0) repair.merge_tolerance = options.merge_tolerance;
  repair.largest_hole = options.largest_hole;
  repair.parts = options.largest_part ? mesh::Parts::kKeepLargest : mesh::Parts::kKeepAll;
  const Outcome outcome{options.input, mesh::repair(surface, repair), {}};
  return finish(surface, outcome, options.output, options.report);
}

int repair_file(const FileOptions& options) {
  if (is_surface_file(options.input)) return repair_surface(options);
  mesh::MeshWithGroups read = read_volume(options.input, options.scale);
  mesh::RepairOptions repair;
  if (options.merge_tolerance > 0) repair.merge_tolerance = options.merge_tolerance;
  repair.parts = options.largest_part ? mesh::Parts::kKeepLargest : mesh::Parts::kKeepAll;
  const Outcome outcome{options.input, mesh::repair(read, repair), {}};
  return finish(read, outcome, options.output, options.report);
}

int optimise_file(const FileOptions& options) {
  mesh::MeshWithGroups read = read_volume(options.input, options.scale);
  Outcome outcome{options.input, orient_all(read), {}};
  outcome.faults = find_faults(read);
  if (has_errors(outcome.faults)) return reject(read, outcome, options.output, options.report);
  const Quality before = measure_quality(read.mesh);
  mesh::NodeMotionOptions motion;
  motion.sweeps = options.sweeps;
  const int moved = mesh::move_nodes(read, motion);
  std::ostream& out = text_output(options.report);
  out << "nodes moved: " << moved << "; " << compare(before, measure_quality(read.mesh)) << '\n';
  outcome.faults = find_faults(read);
  write_volume(read, options.output.file, options.output.format());
  return report(read, outcome, options.report);
}

using Run = int (*)(const FileOptions&);

std::pair<CLI::App*, std::shared_ptr<FileOptions>> add(CLI::App& app, int& code,
                                                       const std::string& name,
                                                       const std::string& about, Run run) {
  auto options = std::make_shared<FileOptions>();
  CLI::App* command = app.add_subcommand(name, about);
  command
      ->add_option("input", options->input,
                   ".msh (Gmsh 2.2, 4.1), .node or .ele (TetGen), .veg (Vega), .vtu; .stl, .obj")
      ->required();
  if (run != check_file) add_output_options(*command, options->output);
  add_report_options(*command, options->report);
  add_scale_option(*command, options->scale);
  command->callback([&code, run, options] { code = run(*options); });
  return {command, options};
}

}  // namespace

void add_file_commands(CLI::App& app, int& code) {
  add(app, code, "check", "Says what is wrong with a mesh or a surface, and how good it is",
      check_file);
  add(app, code, "convert", "Writes a mesh in another format; broken ones are rejected",
      convert_file);
  auto [repair, options] =
      add(app, code, "repair", "Repairs a mesh or a surface and reports the changes, or rejects it",
          repair_file);
  repair
      ->add_option("--merge-tolerance", options->merge_tolerance,
                   "Nodes so near are one, by the mesh's size (1e-9; of a surface 1e-7)")
      ->check(CLI::Range(0.0, 0.1));
  repair
      ->add_option("--largest-hole", options->largest_hole,
                   "Edges round a hole of a surface that is closed; 0: none is")
      ->check(CLI::Range(0, 500))
      ->capture_default_str();
  repair->add_flag("--largest-part", options->largest_part, "Drop all other parts");
  auto [optimise, settings] =
      add(app, code, "optimise", "Moves nodes, where the shape allows, for better elements",
          optimise_file);
  optimise->add_option("--sweeps", settings->sweeps, "Over all nodes, at most")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace palpate::mesh_tool
