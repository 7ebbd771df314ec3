#include "tools/mesh/options.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/elasticity/corotational_model.hpp"
#include "core/mesh/element_mesh.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/commands.hpp"
#include "tools/mesh/faults.hpp"
#include "tools/mesh/quality.hpp"

namespace palpate::mesh_tool {
namespace {

/// Measured cost of a step of the daemon's mechanics on this mesh and machine.
struct StepCost {
  bool measured = false;
  std::string why_not;
  int nodes = 0;       // of the order
  double median = 0;   // s, per step on one core
  double slowest = 0;  // s, 99th percentile
  double factor = 0;   // s, of a new factorisation, which runs in the background of the loop
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

elasticity::Body held_body(const mesh::TetrahedralMesh& mesh, mesh::ElementOrder order) {
  elasticity::Body body;
  body.mesh = mesh::make_element_mesh(mesh, order);
  const Eigen::Vector3d lower = mesh.nodes.rowwise().minCoeff(),
                        upper = mesh.nodes.rowwise().maxCoeff();
  int axis = 0;
  const double length = (upper - lower).maxCoeff(&axis);
  elasticity::GraspRegion grasp;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int n = 0; n < body.mesh.node_count(); ++n) {
    const double along = (body.mesh.nodes(axis, n) - lower[axis]) / length;
    if (along < 0.1) body.fixed_nodes.push_back(n);
    if (along <= 0.9) continue;
    grasp.nodes.push_back(n);
    middle += body.mesh.nodes.col(n);
  }
  if (!grasp.nodes.empty())
    grasp.X_OG_rest.translation() = middle / static_cast<double>(grasp.nodes.size());
  body.grasps.push_back(std::move(grasp));
  return body;
}

/// Clamps the nodes at the lower end of the longest axis, constrains those at the upper end (a
/// tenth of the length each) and moves them for some hundred steps of 1 ms, as a hand would.
StepCost measure_step_cost(const mesh::TetrahedralMesh& mesh, mesh::ElementOrder order) {
  constexpr int kSteps = 400, kMostNodes = 20000;
  constexpr double kBudget = 10;  // s, of all steps
  StepCost cost;
  const elasticity::Body body = held_body(mesh, order);
  cost.nodes = body.mesh.node_count();
  if (cost.nodes > kMostNodes) {
    cost.why_not = "more than 20000 nodes";
    return cost;
  }
  if (body.fixed_nodes.size() < 3 || body.grasps[0].nodes.size() < 3) {
    cost.why_not = "too few nodes at the ends to be held";
    return cost;
  }
  elasticity::CorotationalQuasistatic model(body);  // as palpated is by default
  const auto start = Clock::now();
  model.prepare();
  cost.factor = seconds_since(start);
  const double size = (mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).norm();
  std::vector<double> times;
  const auto begin = Clock::now();
  for (int step = 1; step <= kSteps && seconds_since(begin) < kBudget; ++step) {
    math::Pose hand = body.grasps[0].X_OG_rest;
    const double phase = 2 * EIGEN_PI * step * 1e-3;
    hand.translation() +=
        0.05 * size * Eigen::Vector3d(std::sin(phase), std::sin(2 * phase), 1 - std::cos(phase));
    model.hold(0, hand);
    const auto before = Clock::now();
    model.step(1e-3);
    times.push_back(seconds_since(before));
    if (auto* wanted = model.wanted_refactorisation()) {
      const auto refactor = Clock::now();
      wanted->run();
      cost.factor = seconds_since(refactor);
      model.install(*wanted);
    }
  }
  std::sort(times.begin(), times.end());
  cost.measured = true;
  cost.median = times[times.size() / 2];
  cost.slowest = times[times.size() * 99 / 100];
  return cost;
}

std::string text(const StepCost& cost) {
  if (!cost.measured) return "step of the daemon's mechanics: not measured, " + cost.why_not + "\n";
  return common::formatted(
      "step of the daemon's mechanics, here, one core, %d nodes: %.0f us (median), %.0f "
      "us (99 %%); factorisation in parallel %.1f ms\n",
      cost.nodes, 1e6 * cost.median, 1e6 * cost.slowest, 1e3 * cost.factor);
}

nlohmann::json to_json(const StepCost& cost) {
  if (!cost.measured) return {{"nodes", cost.nodes}, {"not_measured", cost.why_not}};
  return {{"nodes", cost.nodes},
          {"median_s", cost.median},
          {"p99_s", cost.slowest},
          {"factorisation_s", cost.factor}};
}

nlohmann::json to_json(const std::vector<mesh::RepairStep>& steps) {
  nlohmann::json list = nlohmann::json::array();
  for (const mesh::RepairStep& step : steps)
    list.push_back({{"what", step.what}, {"numbers", step.numbers}});
  return list;
}

std::string title_of(const Outcome& outcome) {
  return std::filesystem::path(outcome.file).filename().string();
}

std::string heading(const Outcome& outcome) {
  return outcome.file + (outcome.faults.empty() ? ": no faults\n" : ":\n");
}

template <typename Mesh>
void picture(const Mesh& mesh, const Outcome& outcome, const ReportOptions& options,
             std::ostream& out) {
  if (options.picture.empty()) return;
  std::string title = title_of(outcome) + ": ";
  if (outcome.faults.empty()) title += "no faults";
  for (std::size_t i = 0; i < outcome.faults.size(); ++i)
    title += (i > 0 ? ", " : "") + outcome.faults[i].kind;
  try {
    draw_faults(background(mesh), outcome.faults, title, options.picture);
    out << "picture: " << options.picture << '\n';
  } catch (const std::exception& error) {
    // Faults have been reported as text.
    std::cerr << "palpate-mesh: no picture: " << error.what() << '\n';
  }
}

}  // namespace

FileFormat OutputOptions::format() const {
  FileFormat format;
  format.gmsh.version = version == "2.2" ? mesh::GmshVersion::k2_2 : mesh::GmshVersion::k4_1;
  format.gmsh.encoding = binary ? mesh::Encoding::kBinary : mesh::Encoding::kText;
  format.gmsh.order = order == 2 ? mesh::ElementOrder::kQuadratic : mesh::ElementOrder::kLinear;
  format.first = first;
  return format;
}

void add_output_options(CLI::App& command, OutputOptions& options) {
  command
      .add_option("output", options.file,
                  "File to write: .msh (Gmsh), .node or .ele (TetGen, both), .veg (Vega), .vtu; "
                  ".stl or .obj for the boundary alone")
      ->required();
  command
      .add_option("--order", options.order,
                  "2: 10-node elements (.msh, .vtu). palpated adds the middles of edges itself and "
                  "needs 1; of 2 it keeps the curved volume")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command.add_option("--msh", options.version, "Version of .msh")
      ->check(CLI::IsMember({"2.2", "4.1"}))
      ->capture_default_str();
  command.add_flag("--binary", options.binary, "Binary .msh, base64 in .vtu");
  command.add_option("--first", options.first, "Number of the first node in .node, .ele, .veg")
      ->check(CLI::Range(0, 1))
      ->capture_default_str();
}

void add_report_options(CLI::App& command, ReportOptions& options) {
  command.add_option("--json", options.json, "All results as JSON; - for the standard output");
  command.add_option("--picture", options.picture,
                     "PNG of the mesh with its faults in colour (where a mesh is rejected one is "
                     "made in any case)");
  command.add_option("--histograms", options.histograms, "PNG of the elements' quality");
  command.add_flag("--cost", options.cost,
                   "Measure what a step of palpated's mechanics costs, at both orders");
}

void add_scale_option(CLI::App& command, double& scale) {
  const std::map<std::string, double> units{{"m", 1},     {"dm", 0.1},  {"cm", 0.01},
                                            {"mm", 1e-3}, {"um", 1e-6}, {"inch", 0.0254}};
  command
      .add_option("--scale", scale,
                  "Factor from the file's unit to m, or the unit: m, dm, cm, mm, um, inch")
      ->transform(CLI::Transformer(units))
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

std::ostream& text_output(const ReportOptions& options) {
  return options.json == "-" ? std::cerr : std::cout;
}

std::string text(const std::vector<mesh::RepairStep>& steps) {
  std::string result;
  for (const mesh::RepairStep& step : steps) {
    result += "repaired: " + step.what + ": " + std::to_string(step.numbers.size()) + " (" +
              list_numbers(step.numbers) + ")\n";
  }
  return result;
}

int report(const mesh::MeshWithGroups& mesh, const Outcome& outcome, const ReportOptions& options) {
  std::ostream& out = text_output(options);
  const bool is_broken = has_errors(outcome.faults);
  out << heading(outcome) << text(outcome.steps) << text(outcome.faults);
  nlohmann::json json{{"file", outcome.file},
                      {"repaired", to_json(outcome.steps)},
                      {"faults", to_json(outcome.faults)},
                      {"good", !is_broken}};
  const auto is_countable = [](const Fault& fault) {
    return fault.kind != "out_of_range" && fault.kind != "not_finite" && fault.kind != "empty";
  };
  if (std::all_of(outcome.faults.begin(), outcome.faults.end(), is_countable) &&
      mesh.mesh.tetrahedron_count() > 0) {
    const Quality quality = measure_quality(mesh.mesh);
    out << text(quality);
    json["quality"] = to_json(quality);
    if (!options.histograms.empty()) {
      draw_histograms(quality, title_of(outcome), options.histograms);
      out << "histograms: " << options.histograms << '\n';
    }
  }
  if (options.cost && !is_broken) {
    for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
      const StepCost cost = measure_step_cost(mesh.mesh, order);
      const bool quadratic = order == mesh::ElementOrder::kQuadratic;
      out << "order " << (quadratic ? 2 : 1) << ": " << text(cost);
      json["step_cost"][quadratic ? "order_2" : "order_1"] = to_json(cost);
    }
  }
  picture(mesh, outcome, options, out);
  json.update(options.more);
  if (!options.json.empty()) common::write_json(json, options.json);
  return is_broken ? kBroken : kGood;
}

int report(const mesh::TriangleSurface& surface, const Outcome& outcome,
           const ReportOptions& options) {
  std::ostream& out = text_output(options);
  out << heading(outcome) << text(outcome.steps) << text(outcome.faults) << surface.point_count()
      << " points, " << surface.triangle_count() << " triangles\n";
  nlohmann::json json{{"file", outcome.file},
                      {"repaired", to_json(outcome.steps)},
                      {"faults", to_json(outcome.faults)},
                      {"points", surface.point_count()},
                      {"triangles", surface.triangle_count()},
                      {"good", !has_errors(outcome.faults)}};
  if (!has_errors(outcome.faults)) {
    const double volume = mesh::enclosed_volume(surface);
    out << "encloses " << mesh::shortest(volume) << " m^3\n";
    json["volume_m3"] = volume;
  }
  picture(surface, outcome, options, out);
  if (!options.json.empty()) common::write_json(json, options.json);
  return has_errors(outcome.faults) ? kBroken : kGood;
}

}  // namespace palpate::mesh_tool
