#include "core/estimation/virtual_loads.hpp"

#include <algorithm>
#include <vector>

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;

void add_node(mesh::PointWeights& pattern, int node, double weight) {
  pattern.nodes[static_cast<std::size_t>(pattern.count)] = node;
  pattern.weights[static_cast<std::size_t>(pattern.count)] = weight;
  ++pattern.count;
}

}  // namespace

VirtualLoads::VirtualLoads(const elasticity::Body& body) {
  static_assert(kStates == Forces::RowsAtCompileTime && kCount <= elasticity::kContactSlots);
  const Eigen::Matrix3Xd& x = body.mesh.nodes;
  std::vector<bool> is_free(static_cast<std::size_t>(x.cols()), true);
  for (const int node : body.fixed_nodes) is_free[static_cast<std::size_t>(node)] = false;
  for (const elasticity::GraspRegion& grasp : body.grasps)
    for (const int node : grasp.nodes) is_free[static_cast<std::size_t>(node)] = false;

  const Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  (high - low).maxCoeff(&axis_);
  double from = high[axis_], to = low[axis_];
  for (int node = 0; node < x.cols(); ++node) {
    if (!is_free[static_cast<std::size_t>(node)]) continue;
    from = std::min(from, x(axis_, node));
    to = std::max(to, x(axis_, node));
  }
  constexpr int kStations = 10;  // capacity of a pattern
  for (int i = 0; i < kStations; ++i) {
    const double along = (i + 0.5) / kStations;
    Vector3d station = 0.5 * (low + high);
    station[axis_] = from + along * (to - from);
    int best = -1;
    for (int node = 0; node < x.cols(); ++node) {
      if (!is_free[static_cast<std::size_t>(node)]) continue;
      if (best < 0 || (x.col(node) - station).norm() < (x.col(best) - station).norm()) best = node;
    }
    if (best < 0) return;
    is_free[static_cast<std::size_t>(best)] = false;  // each node once
    add_node(patterns_[0], best, 1.0 / kStations);
    add_node(patterns_[1], best, (2 * along - 1) / kStations);
  }
}

void VirtualLoads::watch(elasticity::DeformationModel& model) const noexcept {
  for (int slot = 0; slot < kCount; ++slot) model.watch_contact(slot, patterns_[slot]);
}

bool VirtualLoads::is_known(const elasticity::Sensitivity& sensitivity) noexcept {
  if (!sensitivity.valid) return false;
  for (int slot = 0; slot < kCount; ++slot) {
    if (!(sensitivity.dx_dforce[slot].cwiseAbs().maxCoeff() > 0)) return false;
  }
  return true;
}

VirtualLoads::Forces VirtualLoads::for_distance(
    double distance, const elasticity::Sensitivity& sensitivity) const noexcept {
  Forces forces = Forces::Zero();
  for (int k = 0; k < kCount; ++k) {
    double softest = 0;  // m/N
    for (int axis = 0; axis < 3; ++axis)
      if (axis != axis_)
        softest = std::max(softest, sensitivity.dx_dforce[k].col(axis).cwiseAbs().maxCoeff());
    forces.segment<3>(3 * k).setConstant(distance / softest);
    forces[3 * k + axis_] = 0;
  }
  return forces;
}

void VirtualLoads::add_to(Eigen::Matrix3Xd& loads, const Forces& forces) const noexcept {
  for (int k = 0; k < kCount; ++k) {
    const mesh::PointWeights& pattern = patterns_[k];
    for (int i = 0; i < pattern.count; ++i)
      loads.col(pattern.nodes[i]) += pattern.weights[i] * forces.segment<3>(3 * k);
  }
}

}  // namespace palpate::estimation
