#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/mesh/node_motion.hpp"
#include "core/mesh/surface_repair.hpp"
#include "core/mesh/surface_report.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/commands.hpp"
#include "tools/mesh/filling.hpp"
#include "tools/mesh/ftetwild_program.hpp"
#include "tools/mesh/options.hpp"

namespace palpate::mesh_tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPython = "tools/mesh/palpate_scan";

struct ScanOptions {
  OutputOptions output;
  ReportOptions report;
  std::string input;
  std::string deviation_picture;
  double scale = 1;
  int nodes = 700;
  double most_unseen = 0.3;
  MeshingOptions meshing;
  FtetwildOptions ftetwild;
};

nlohmann::json json_of(const fs::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in);
}

/// Edge length of a mesh of about `nodes` quadratic nodes: five nodes to the cube of an edge, and
/// half as many again as belong to a boundary.
double first_edge(double volume, int nodes) { return std::cbrt(7.5 * std::abs(volume) / nodes); }

std::string surface_text(const nlohmann::json& surface) {
  std::string text = common::formatted(
      "surface: %d points %.2f mm apart, %d outliers left out; %.1f %% of it seen by none",
      surface["points"].get<int>(), 1e3 * surface["spacing_m"].get<double>(),
      surface["outliers"].get<int>(), 100 * surface["unseen_share"].get<double>());
  if (surface["support_points"] > 0) text += "; closed by a plane where the object stood";
  if (surface["parts_dropped"] > 0)
    text += "; " + surface["parts_dropped"].dump() + " smaller parts left out";
  if (!surface["edges_sharpened"]) text += "; edges stay rounded, sharp ones would cross";
  return text + "\n";
}

std::string deviation_text(const nlohmann::json& deviation) {
  std::string text;
  for (const auto& [key, name] : {std::pair{"cloud_from_surface", "cloud from mesh"},
                                  {"surface_from_cloud", "mesh from cloud"}}) {
    const nlohmann::json& of = deviation[key];
    text += common::formatted("deviation of %s, mm: mean %.3f, 95 %% %.3f, largest %.3f\n", name,
                              1e3 * of["mean_m"].get<double>(), 1e3 * of["p95_m"].get<double>(),
                              1e3 * of["largest_m"].get<double>());
  }
  return text;
}

int scan_cloud(const ScanOptions& options) {
  const common::TemporaryFolder folder("palpate-scan");
  const std::string made = (folder.path() / "surface.obj").string(),
                    facts = (folder.path() / "facts.json").string(),
                    written = (folder.path() / "boundary.obj").string();
  nlohmann::json more;
  {
    common::Progress progress(1, 1, "surface of the cloud");
    common::run_python(kPython,
                       {"surface", options.input, made, "--scale", mesh::shortest(options.scale),
                        "--most-unseen", mesh::shortest(options.most_unseen), "--json", facts});
    more["scan"]["surface"] = json_of(facts);
    progress.finish(true, more["scan"]["surface"]["triangles"].dump() + " triangles");
  }
  mesh::TriangleSurface surface = read_surface(made, 1);
  Outcome outcome{options.input, mesh::repair(surface, {}), find_faults(surface)};
  if (has_errors(outcome.faults)) return reject(surface, outcome, options.output, options.report);
  std::ostream& out = text_output(options.report);
  out << surface_text(more["scan"]["surface"]);
  // What a trial reports would confuse.
  std::ostringstream ignored;
  BudgetedMesh found = fill_within_budget(
      first_edge(mesh::enclosed_volume(surface), options.nodes), options.nodes, [&](double edge) {
        MeshingOptions meshing = options.meshing;
        meshing.edge = edge;
        mesh::MeshWithGroups filled =
            fill_and_refine(surface, meshing, options.output.order, ignored);
        mesh::move_nodes(filled);  // inside: the boundary has been moved
        if (has_errors(find_faults(filled)))
          throw std::runtime_error("gmsh's elements are broken:\n" + text(find_faults(filled)));
        return filled;
      });
  write_surface(boundary(found.mesh.mesh), written);
  std::vector<std::string> arguments{
      "deviation", options.input, written, "--scale", mesh::shortest(options.scale),
      "--json",    facts};
  if (!options.deviation_picture.empty())
    arguments.insert(arguments.end(), {"--picture", options.deviation_picture});
  common::run_python(kPython, arguments);
  more["scan"]["deviation"] = json_of(facts);
  more["scan"]["edge_m"] = found.edge;
  out << deviation_text(more["scan"]["deviation"]);
  ReportOptions report = options.report;
  report.more = more;
  return finish(found.mesh, {options.output.file, {}, {}}, options.output, report);
}

int scan_triangles(const ScanOptions& options) {
  if (!options.deviation_picture.empty()) {
    throw std::runtime_error("--deviation: " + options.input +
                             " is a surface; the deviation is that of a cloud");
  }
  const mesh::TriangleSurface surface = read_surface(options.input, options.scale);
  const Eigen::Vector3d sides =
      surface.points.rowwise().maxCoeff() - surface.points.rowwise().minCoeff();
  if (surface.triangle_count() == 0 || !sides.allFinite()) {
    throw std::runtime_error(options.input + ": no triangles, or coordinates that are not finite");
  }
  const BudgetedMesh found = fill_within_budget(
      first_edge(0.5 * sides.prod(), options.nodes), options.nodes, [&](double edge) {
        FtetwildOptions more = options.ftetwild;
        more.edge = edge;
        more.time_limit = options.meshing.time_limit;
        mesh::MeshWithGroups filled = fill_by_ftetwild(surface, more);
        mesh::move_nodes(filled);
        return filled;
      });
  return finish(found.mesh, {options.output.file, {}, {}}, options.output, options.report);
}

}  // namespace

void add_scan_command(CLI::App& app, int& code) {
  auto options = std::make_shared<ScanOptions>();
  CLI::App* command = app.add_subcommand(
      "scan",
      "The inside of a scanned cloud, or of triangles with faults, within a number of nodes");
  command
      ->add_option("input", options->input,
                   "Cloud, .ply, .pcd, .xyz, .txt or .npy: closed by Open3D, filled by gmsh; or "
                   "triangles with holes and crossings, .stl or .obj: filled by fTetWild")
      ->required();
  add_output_options(*command, options->output);
  add_report_options(*command, options->report);
  add_scale_option(*command, options->scale);
  command
      ->add_option("--nodes", options->nodes,
                   "Largest number of nodes with 10-node elements, as palpated uses them")
      ->check(CLI::Range(10, 3000))
      ->capture_default_str();
  command
      ->add_option("--most-unseen", options->most_unseen,
                   "Share of the closed surface that may be far from all points")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--deviation", options->deviation_picture,
                      "PNG of the cloud coloured by its distance from the mesh");
  command
      ->add_option("--feature-angle", options->meshing.feature_angle,
                   "Degrees between triangles from which the edge between them is kept")
      ->check(CLI::Range(1.0, 179.0))
      ->capture_default_str();
  command->add_option("--time-limit", options->meshing.time_limit, "For gmsh and fTetWild, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--gmsh", options->meshing.program, "The program gmsh, a name or a path")
      ->capture_default_str();
  command
      ->add_option("--ftetwild", options->ftetwild.program,
                   "The program of fTetWild, a name or a path")
      ->capture_default_str();
  command
      ->add_option("--envelope", options->ftetwild.envelope,
                   "Largest deviation of fTetWild's mesh from the triangles, by their diagonal")
      ->check(CLI::Range(1e-5, 0.1))
      ->capture_default_str();
  command->callback([&code, options] {
    code = is_surface_file(options->input) ? scan_triangles(*options) : scan_cloud(*options);
  });
}

}  // namespace palpate::mesh_tool
