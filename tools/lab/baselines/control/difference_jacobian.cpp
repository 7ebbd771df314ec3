#include "tools/lab/baselines/control/difference_jacobian.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/control/jacobian_providers.hpp"

namespace palpate::baselines {
namespace {

std::vector<int> corners_of(const std::vector<int>& nodes, int corner_count) {
  std::vector<int> corners;
  for (const int node : nodes)
    if (node < corner_count) corners.push_back(node);
  return corners;
}

}  // namespace

elasticity::Body corner_body(const elasticity::Body& body) {
  elasticity::Body corners = body;
  const int count = body.mesh.corner_count;
  corners.mesh.order = mesh::ElementOrder::kLinear;
  corners.mesh.nodes = body.mesh.nodes.leftCols(count).eval();
  corners.mesh.elements = body.mesh.elements.topRows(4).eval();
  corners.fixed_nodes = corners_of(body.fixed_nodes, count);
  for (elasticity::GraspRegion& grasp : corners.grasps)
    grasp.nodes = corners_of(grasp.nodes, count);
  return corners;
}

DifferenceJacobian::DifferenceJacobian(const Options& options, const elasticity::Body& body,
                                       int grasp, const Factory& factory)
    : options_(options), grasp_(grasp), node_count_(body.mesh.node_count()) {
  if (grasp < 0 || grasp >= static_cast<int>(body.grasps.size()))
    throw std::invalid_argument("nothing is grasped");
  if (!(options.distance > 0 && options.angle > 0 && options.dt > 0))
    throw std::invalid_argument("a difference needs positive steps");
  parents_.resize(node_count_);
  for (int n = 0; n < body.mesh.corner_count; ++n) parents_[n] = {n, n};
  for (int e = 0; e < body.mesh.element_count() && body.mesh.nodes_per_element() == 10; ++e) {
    for (int m = 0; m < 6; ++m) {
      const int* ends = mesh::kTetrahedronEdges[m];
      parents_[body.mesh.elements(4 + m, e)] = {body.mesh.elements(ends[0], e),
                                                body.mesh.elements(ends[1], e)};
    }
  }
  const elasticity::Body corners = corner_body(body);
  for (int copy = 0; copy < 7; ++copy) {
    models_.push_back(factory(corners));
    models_.back()->prepare();
    models_.back()->set_gravity(corners.gravity_O);
  }
  by_motion_.setZero(3 * body.mesh.corner_count, 6);
  settle(body.grasps[grasp].X_OG_rest, options.first_steps);
}

void DifferenceJacobian::settle(const math::Pose& X_OG, int steps) noexcept {
  for (int step = 0; step < steps; ++step)
    for (int copy = 0; copy < 7; ++copy) advance(copy, X_OG);
  next_ = 0;
  compare();
}

void DifferenceJacobian::advance(int copy, const math::Pose& X_OG) noexcept {
  math::Pose X = X_OG;
  if (copy > 0 && copy < 4) X.translation()[copy - 1] += options_.distance;
  if (copy >= 4)
    X.linear() = math::exp_rotation(options_.angle * Eigen::Vector3d::Unit(copy - 4)) * X.linear();
  models_[copy]->hold(grasp_, X);
  models_[copy]->step(options_.dt);
}

void DifferenceJacobian::compare() noexcept {
  const Eigen::Matrix3Xd& middle = models_[0]->positions();
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? options_.distance : options_.angle;
    const Eigen::Matrix3Xd& moved = models_[k + 1]->positions();
    for (int n = 0; n < middle.cols(); ++n)
      by_motion_.block<3, 1>(3 * n, k) = (moved.col(n) - middle.col(n)) / step;
  }
}

bool DifferenceJacobian::update(const shape::Feature& feature, const elasticity::DeformationModel&,
                                const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  if (next_ == 0) X_round_ = X_OG;
  advance(next_, X_round_);
  next_ = (next_ + 1) % 7;
  if (next_ == 0) compare();
  const std::vector<int>& support = feature.support();
  if (!support.empty() && support.back() >= node_count_) return false;
  control::accumulate_support(
      feature,
      [&](int node) -> Eigen::Matrix<double, 3, 6> {
        return 0.5 * (by_motion_.middleRows<3>(3 * parents_[node].a) +
                      by_motion_.middleRows<3>(3 * parents_[node].b));
      },
      J);
  return J.allFinite();
}

}  // namespace palpate::baselines
