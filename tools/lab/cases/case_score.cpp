#include "tools/lab/cases/case_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/point_locator.hpp"

namespace palpate::cases {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using nlohmann::json;

/// The case is about twist if its reference is one, or if its load varies with position.
bool monitors_twist(const CaseFile& c) {
  const json reference = c.summary.value("reference", json::object());
  const json monitored = reference.is_object() ? reference.value("monitored", json()) : json();
  if (monitored.is_string()) return monitored.get<std::string>().find("twist") != std::string::npos;
  return std::any_of(c.loads.begin(), c.loads.end(),
                     [](const CaseLoad& load) { return !load.total_force; });
}

std::optional<double> relative(const json& row, const char* key,
                               const std::optional<Vector3d>& ours) {
  const auto stored = row.find(key);
  if (!ours || stored == row.end() || !stored->is_array() || stored->size() != 3) return {};
  const Vector3d theirs(stored->at(0).get<double>(), stored->at(1).get<double>(),
                        stored->at(2).get<double>());
  return (*ours - theirs).norm() / theirs.norm();
}

}  // namespace

CaseFigures score_shape(const CaseFile& c, const CaseProblem& problem, const Matrix3Xd& positions,
                        const Matrix3Xd* reactions) {
  CaseFigures figures;
  figures.largest_reference = c.largest_reference();
  const elasticity::Body& body = problem.body;
  const mesh::PointLocator locator(body.mesh);
  double sum = 0;
  for (const CaseProbe& probe : c.probes) {
    const mesh::PointWeights place = locator.locate(probe.rest);
    const Vector3d u = place.interpolate(positions) - place.interpolate(body.mesh.nodes);
    const double error = (u - probe.displacement).norm();
    sum += error * error;
    figures.probe_max = std::max(figures.probe_max, error);
    figures.outside = std::max(figures.outside, place.outside);
  }
  if (!c.probes.empty()) figures.probe_rms = std::sqrt(sum / static_cast<double>(c.probes.size()));

  const SurfacePatch patch(body.mesh, problem.monitored);
  if (!patch.empty()) {
    figures.mean = patch.mean(positions - body.mesh.nodes);
    if (monitors_twist(c)) figures.twist_deg = patch.twist(positions) * 180 / M_PI;
  }
  if (reactions == nullptr) return figures;
  if (problem.held[0])
    figures.grasp =
        elasticity::patch_wrench(body.grasps[0], *problem.held[0], positions, *reactions);
  if (!body.fixed_nodes.empty())
    figures.fixed =
        elasticity::patch_wrench({body.fixed_nodes}, math::Pose::Identity(), positions, *reactions);
  return figures;
}

double BaselineDifference::largest_share() const {
  return std::max(std::abs(rms_share), std::abs(max_share));
}

double BaselineDifference::largest_relative() const {
  double largest = 0;
  for (const auto& value : {mean, twist, force, moment})
    largest = std::max(largest, std::abs(value.value_or(0)));
  return largest;
}

const json* baseline_row(const CaseFile& c, mesh::ElementOrder order, const std::string& mesh) {
  const auto rows = c.summary.find("baseline_on_delivered_meshes");
  if (rows == c.summary.end() || !rows->is_object()) return nullptr;
  const auto row = rows->find((order == mesh::ElementOrder::kLinear ? "P1_" : "P2_") + mesh);
  return row == rows->end() || !row->is_object() ? nullptr : &*row;
}

BaselineDifference compare(const CaseFigures& figures, const json& row) {
  BaselineDifference difference;
  const auto stored = [&row](const char* key) -> std::optional<double> {
    const auto found = row.find(key);
    if (found == row.end() || !found->is_number()) return {};
    return found->get<double>();
  };
  if (const auto theirs = stored("probe_rms_error_over_max_u"))
    difference.rms_share = figures.rms_share() - *theirs;
  if (const auto theirs = stored("probe_max_error_over_max_u"))
    difference.max_share = figures.max_share() - *theirs;
  if (const auto theirs = stored("twist_deg"); theirs && figures.twist_deg)
    difference.twist = std::abs(*figures.twist_deg / *theirs - 1);
  difference.mean = relative(row, "mean", figures.mean);
  if (figures.grasp) {
    difference.force = relative(row, "force", figures.grasp->force);
    difference.moment = relative(row, "moment", figures.grasp->torque);
  }
  return difference;
}

bool CaseScore::converged() const {
  return equilibrium.converged && (!incremental || incremental->converged) &&
         (!dynamic || dynamic->at_rest);
}

CaseScore score_case(const CaseFile& c, const std::string& mesh_name,
                     const mesh::MeshWithGroups& mesh, mesh::ElementOrder order,
                     const ScoreCaseOptions& options) {
  const CaseProblem problem = make_problem(c, mesh, order);
  CaseScore score;
  score.name = c.name;
  score.mesh = mesh_name;
  score.order = order;
  score.nodes = problem.body.mesh.node_count();
  score.elements = problem.body.mesh.element_count();
  score.baseline = baseline_row(c, order, mesh_name);
  score.equilibrium = solve(problem);
  const Matrix3Xd& positions = score.equilibrium.positions;
  score.figures = score_shape(c, problem, positions, &score.equilibrium.reactions);
  if (!score.equilibrium.converged) return score;
  if (options.ticks > 0) score.incremental = run_incremental(problem, positions, options.ticks);
  if (options.dynamic) {
    score.dynamic = run_dynamic(problem, score.equilibrium, *options.dynamic);
    score.dynamic_figures = score_shape(c, problem, score.dynamic->positions, nullptr);
    if (problem.held[0]) score.dynamic_figures->grasp = score.dynamic->grasp;
  }
  return score;
}

}  // namespace palpate::cases
