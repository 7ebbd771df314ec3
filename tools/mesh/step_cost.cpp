#include "tools/mesh/step_cost.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/elasticity/corotational_model.hpp"

namespace palpate::mesh_tool {
namespace {

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

}  // namespace

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
  char line[240];
  if (!cost.measured) return "step of the daemon's mechanics: not measured, " + cost.why_not + "\n";
  std::snprintf(line, sizeof line,
                "step of the daemon's mechanics, here, one core, %d nodes: %.0f us (median), %.0f "
                "us (99 %%); factorisation beside it %.1f ms\n",
                cost.nodes, 1e6 * cost.median, 1e6 * cost.slowest, 1e3 * cost.factor);
  return line;
}

nlohmann::json to_json(const StepCost& cost) {
  if (!cost.measured) return {{"nodes", cost.nodes}, {"not_measured", cost.why_not}};
  return {{"nodes", cost.nodes},
          {"median_s", cost.median},
          {"p99_s", cost.slowest},
          {"factorisation_s", cost.factor}};
}

}  // namespace palpate::mesh_tool
