#include <cmath>
#include <iostream>
#include <memory>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/near_nodes.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/round_mesh.hpp"
#include "core/mesh/surface_repair.hpp"
#include "tools/mesh/commands.hpp"
#include "tools/mesh/filling.hpp"
#include "tools/mesh/gmsh_program.hpp"
#include "tools/mesh/options.hpp"

namespace palpate::mesh_tool {
namespace {

struct MakeOptions {
  OutputOptions output;
  ReportOptions report;
  std::vector<double> size;
  std::vector<int> cells;
  std::string cut = "six";
  double radius = 0;
  double length = 0;
  std::string mesher = "auto";
  std::string input;
  double scale = 1;
  double volume_factor = 0;
  bool as_it_is = false;
  bool keep_triangles = false;
  bool largest_part = false;
  double merge_tolerance = 1e-7;
  int largest_hole = 32;
  MeshingOptions meshing{0};
};

constexpr double kMostMeshNodes = 5e6;

/// The number of edges closest to the requested length, at least one.
int count_of(double length, double edge) {
  return std::max(1, static_cast<int>(std::lround(length / edge)));
}

void check_count(double nodes) {
  if (nodes > kMostMeshNodes) {
    throw std::runtime_error(
        "--edge: the mesh would have more than 5 million nodes; use longer "
        "edges");
  }
}

int finish(const mesh::MeshWithGroups& made, const MakeOptions& options) {
  return finish(made, {options.output.file, {}, {}}, options.output, options.report);
}

int make_box(const MakeOptions& options) {
  std::array<int, 3> cells{};
  double nodes = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = options.size[axis];
    if (options.cells.empty()) check_count(nodes * size / options.meshing.edge);
    cells[axis] =
        options.cells.empty() ? count_of(size, options.meshing.edge) : options.cells[axis];
    nodes *= cells[axis] + 1;
    check_count(nodes);
  }
  const mesh::GridPlanes planes = mesh::even_planes(
      Eigen::Vector3d::Zero(), Eigen::Map<const Eigen::Vector3d>(options.size.data()), cells);
  mesh::MeshWithGroups made;
  made.mesh =
      mesh::make_grid(planes, options.cut == "five" ? mesh::CellCut::kFive : mesh::CellCut::kSix);
  mesh::group_sides(made, [&](const Eigen::Matrix3d& corners) -> std::string {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string letter(1, "xyz"[axis]);
      if (corners.row(axis).maxCoeff() == 0) return letter + "_min";
      if (corners.row(axis).minCoeff() == planes[axis].back()) return letter + "_max";
    }
    return "";
  });
  return finish(made, options);
}

/// Round bodies: by layers and shells if these give good elements, otherwise by gmsh on a fine
/// surface of them.
int make_round(const MakeOptions& options,
               const std::function<mesh::MeshWithGroups(double, mesh::RoundSides)>& make) {
  constexpr double kGoodEnough = 0.2;  // radius ratio
  const bool quadratic = options.output.order == 2;
  const auto sides = quadratic ? mesh::RoundSides::kCurved : mesh::RoundSides::kFull;
  if (options.mesher != "gmsh") {
    const mesh::MeshWithGroups own = make(options.meshing.edge, sides);
    const double worst = mesh::check(own.mesh).quality_min;
    if (options.mesher == "own" || worst >= kGoodEnough) return finish(own, options);
    std::cerr << "own elements would have a radius ratio of " << mesh::shortest(worst)
              << " at least: gmsh makes better ones (--mesher own to have them anyway)\n";
  }
  const mesh::TriangleSurface surface =
      boundary(make(options.meshing.edge / 3, mesh::RoundSides::kFull).mesh);
  const mesh::MeshWithGroups filled =
      fill_and_refine(surface, options.meshing, options.output.order, text_output(options.report));
  return finish(filled, options);
}

int make_cylinder(const MakeOptions& options) {
  return make_round(options, [&](double edge, mesh::RoundSides sides) {
    check_count(3 * options.radius * options.radius * options.length / (edge * edge * edge));
    return mesh::make_cylinder(options.radius, options.length, count_of(options.radius, edge),
                               count_of(options.length, edge), sides);
  });
}

int make_ellipsoid(const MakeOptions& options) {
  const Eigen::Vector3d axes(options.size[0], options.size[1], options.size[2]);
  return make_round(options, [&](double edge, mesh::RoundSides sides) {
    check_count(4 * axes.maxCoeff() * axes.maxCoeff() * axes.maxCoeff() / (edge * edge * edge));
    return mesh::make_ellipsoid(axes, count_of(std::cbrt(axes.prod()), edge), sides);
  });
}

int make_from_surface(const MakeOptions& options) {
  mesh::TriangleSurface surface = read_surface(options.input, options.scale);
  Outcome outcome{options.input, {}, find_faults(surface)};
  if (has_errors(outcome.faults) && !options.as_it_is) {
    mesh::SurfaceRepairOptions repair;
    repair.merge_tolerance = options.merge_tolerance;
    repair.largest_hole = options.largest_hole;
    repair.parts = options.largest_part ? mesh::Parts::kKeepLargest : mesh::Parts::kKeepAll;
    outcome.steps = mesh::repair(surface, repair);
    outcome.faults = find_faults(surface);
  }
  if (has_errors(outcome.faults)) return reject(surface, outcome, options.output, options.report);
  std::ostream& out = text_output(options.report);
  out << options.input << ":\n" << text(outcome.steps) << text(outcome.faults);
  const double size = mesh::diagonal(surface.points);
  check_count(std::pow(size / options.meshing.edge, 3) / 10);
  const mesh::MeshWithGroups filled =
      fill_and_refine(surface, options.meshing, options.output.order, text_output(options.report));
  return finish(filled, options);
}

void add_edge_option(CLI::App& command, MakeOptions& options) {
  command.add_option("--edge", options.meshing.edge, "Length that edges should have, m")
      ->check(CLI::PositiveNumber)
      ->required();
}

void add_gmsh_options(CLI::App& command, MakeOptions& options) {
  command.add_option("--time-limit", options.meshing.time_limit, "For gmsh, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--gmsh", options.meshing.program, "The program gmsh, a name or a path")
      ->capture_default_str();
}

using Make = int (*)(const MakeOptions&);

CLI::App* add(CLI::App& app, int& code, const std::string& name, const std::string& about, Make run,
              const std::shared_ptr<MakeOptions>& options) {
  CLI::App* command = app.add_subcommand(name, about);
  add_output_options(*command, options->output);
  add_report_options(*command, options->report);
  command->callback([&code, run, options] { code = run(*options); });
  return command;
}

}  // namespace

void add_make_commands(CLI::App& app, int& code) {
  auto box = std::make_shared<MakeOptions>();
  CLI::App* command =
      add(app, code, "box", "A box from the origin, cells of a grid cut up", make_box, box);
  command->add_option("--size", box->size, "Along x, y and z, m")
      ->expected(3)
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber)
      ->required();
  CLI::App* density = command->add_option_group("density");
  density->add_option("--edge", box->meshing.edge, "Length that edges should have, m")
      ->check(CLI::PositiveNumber);
  density->add_option("--cells", box->cells, "Along x, y and z")
      ->expected(3)
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 2000));
  density->require_option(1);
  command->add_option("--cut", box->cut, "Tetrahedra a cell: six, all alike, or five")
      ->check(CLI::IsMember({"five", "six"}))
      ->capture_default_str();

  auto cylinder = std::make_shared<MakeOptions>();
  command =
      add(app, code, "cylinder", "A cylinder along x from the origin", make_cylinder, cylinder);
  command->add_option("--radius", cylinder->radius, "m")->check(CLI::PositiveNumber)->required();
  command->add_option("--length", cylinder->length, "m")->check(CLI::PositiveNumber)->required();

  auto ellipsoid = std::make_shared<MakeOptions>();
  CLI::App* round =
      add(app, code, "ellipsoid", "An ellipsoid about the origin", make_ellipsoid, ellipsoid);
  round->add_option("--half-axes", ellipsoid->size, "Along x, y and z, m")
      ->expected(3)
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber)
      ->required();
  for (const auto& [to, options] : {std::pair{command, cylinder}, std::pair{round, ellipsoid}}) {
    add_edge_option(*to, *options);
    to->add_option("--mesher", options->mesher,
                   "own: layers and shells; gmsh; auto: own where its worst radius ratio is 0.2")
        ->check(CLI::IsMember({"auto", "own", "gmsh"}))
        ->capture_default_str();
    add_gmsh_options(*to, *options);
  }

  auto surface = std::make_shared<MakeOptions>();
  command = app.add_subcommand("surface", "The inside of a surface (STL or OBJ), by gmsh");
  command->add_option("input", surface->input, ".stl (ASCII or binary) or .obj")->required();
  add_output_options(*command, surface->output);
  add_report_options(*command, surface->report);
  command->callback([&code, surface] { code = make_from_surface(*surface); });
  add_edge_option(*command, *surface);
  add_scale_option(*command, surface->scale);
  command->add_flag("--as-it-is", surface->as_it_is, "Do not repair the surface first");
  command->add_flag("--largest-part", surface->largest_part, "Drop all other parts");
  command
      ->add_option("--merge-tolerance", surface->merge_tolerance,
                   "Points so near are one, by the surface's size")
      ->check(CLI::Range(0.0, 0.1))
      ->capture_default_str();
  command
      ->add_option("--largest-hole", surface->largest_hole,
                   "Edges round a hole that is closed; 0: none is")
      ->check(CLI::Range(0, 500))
      ->capture_default_str();
  command
      ->add_option("--feature-angle", surface->meshing.feature_angle,
                   "Degrees between triangles from which the edge between them is kept")
      ->check(CLI::Range(1.0, 179.0))
      ->capture_default_str();
  command->add_flag_callback(
      "--keep-triangles", [surface] { surface->meshing.triangles = SurfaceTriangles::kKeep; },
      "The surface's own triangles become the boundary");
  add_gmsh_options(*command, *surface);
}

}  // namespace palpate::mesh_tool
