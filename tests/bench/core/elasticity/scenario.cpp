#include "tests/bench/core/elasticity/scenario.hpp"
#include "tests/support/refactor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

const Vector3d kSize(0.20, 0.05, 0.05);  // m
constexpr elasticity::Material kMaterial{1e5, 0.35, 300};
constexpr elasticity::Damping kDamping{2, 0};
constexpr double kTurn = 2 * 3.14159265358979323846;

/// From 0 to 1 within `duration`, without a jump of velocity.
double soft_start(double t, double duration) {
  const double s = std::min(1.0, t / duration);
  return s * s * (3 - 2 * s);
}

}  // namespace

int BarMesh::node_count() const {
  const int per_cell = order == mesh::ElementOrder::kQuadratic ? 2 : 1;
  int count = 1;
  for (int c : cells) count *= per_cell * c + 1;
  return count;
}

std::string BarMesh::text() const {
  return (order == mesh::ElementOrder::kQuadratic ? "quadratic " : "linear ") +
         std::to_string(node_count());
}

std::vector<BarMesh> bar_meshes(mesh::ElementOrder order) {
  std::vector<std::array<int, 3>> cells;
  if (order == mesh::ElementOrder::kLinear) {
    cells = {{18, 3, 3}, {19, 4, 4}, {27, 5, 5}, {31, 7, 7}, {36, 8, 8}, {50, 13, 13}};
  } else {
    cells = {{4, 2, 2}, {9, 2, 2}, {12, 2, 2}, {14, 2, 2}, {12, 3, 3}, {16, 4, 4}};
  }
  std::vector<BarMesh> meshes;
  for (const auto& c : cells) meshes.push_back({order, c});
  return meshes;
}

BarMesh bar_of(mesh::ElementOrder order, int nodes) {
  std::string known;
  for (const BarMesh& mesh : bar_meshes(order)) {
    if (mesh.node_count() == nodes) return mesh;
    known += (known.empty() ? "" : ", ") + std::to_string(mesh.node_count());
  }
  throw std::invalid_argument("no bar of " + std::to_string(nodes) + " nodes; there are " + known);
}

Motion motion_of(const std::string& letter) {
  if (letter == "S") return Motion::kStep;
  if (letter == "L") return Motion::kLarge;
  if (letter == "B") return Motion::kBend;
  throw std::invalid_argument("motion \"" + letter + "\": allowed: S, L, B");
}

std::string letter_of(Motion motion) {
  return motion == Motion::kStep ? "S" : motion == Motion::kLarge ? "L" : "B";
}

Scenario::Scenario(const BarMesh& mesh, Motion motion, double young_modulus, const std::string& law)
    : motion_(motion), force_scale_(young_modulus / kMaterial.young_modulus) {
  body_.mesh = mesh::make_element_mesh(mesh::make_box(kSize, mesh.cells), mesh.order);
  body_.material = kMaterial;
  body_.material.young_modulus = young_modulus;
  body_.damping = kDamping;
  if (const auto* named = elasticity::find_stretch_law(law)) {
    std::vector<double> constants;
    for (const auto& constant : named->constants) constants.push_back(constant.start);
    body_.law = named->make(constants);
  }
  elasticity::GraspRegion clamp;
  clamp.nodes = elasticity::nodes_at(body_.mesh, 0, 0);
  clamp.X_OG_rest.translation() = Vector3d(0, kSize.y() / 2, kSize.z() / 2);
  body_.grasps = {clamp};
  tip_shares_ = elasticity::face_areas(body_.mesh, kSize.x());
  tip_shares_ /= tip_shares_.sum();
}

math::Pose Scenario::clamp_pose(double t) const {
  math::Pose X = body_.grasps[0].X_OG_rest;
  if (motion_ != Motion::kLarge) return X;
  // Two incommensurable frequencies, so that the bar visits ever new orientations.
  const double swing = soft_start(t, 0.1) * kTurn / 6;
  const double shift = soft_start(t, 0.1) * 0.05;
  const double slow = 0.7 * kTurn * t, fast = kTurn * t;
  X.translation() += shift * Vector3d(std::sin(slow), std::sin(fast), std::sin(slow));
  X.linear() = math::exp_rotation(swing * std::sin(fast) * Vector3d::UnitY()) *
               math::exp_rotation(swing * std::sin(slow) * Vector3d::UnitZ());
  return X;
}

Vector3d Scenario::tip_force(double t) const {
  switch (motion_) {
    case Motion::kStep:
      return force_scale_ * Vector3d(0, 0, -0.1);
    case Motion::kBend:
      return force_scale_ * std::min(1.0, t / 0.05) * Vector3d(0, 0, -2);
    default:
      return force_scale_ * Vector3d(0, std::sin(kTurn * t), -std::cos(kTurn * t));
  }
}

void Scenario::apply(double t, elasticity::DeformationModel& model) const {
  model.hold(0, clamp_pose(t));
  model.loads().noalias() = tip_force(t) * tip_shares_.transpose();
}

std::unique_ptr<elasticity::CorotationalModel> make_model(
    const elasticity::Body& body, Mechanics mechanics, const elasticity::SolverOptions& options) {
  std::unique_ptr<elasticity::CorotationalModel> model;
  if (mechanics == Mechanics::kDynamic) {
    model = std::make_unique<elasticity::CorotationalDynamic>(body, options);
  } else {
    model = std::make_unique<elasticity::CorotationalQuasistatic>(body, options);
  }
  model->prepare();
  model->hold(0, body.grasps[0].X_OG_rest);
  support::refactor(*model);
  return model;
}

}  // namespace palpate::bench
