#include "tools/lab/baselines/sensing/deformation_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "core/math/rigid.hpp"

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

/// Columns of `points` in order of their distance from `p`.
std::vector<int> by_distance(const Eigen::Matrix3Xd& points, const Vector3d& p) {
  std::vector<int> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return (points.col(a) - p).squaredNorm() < (points.col(b) - p).squaredNorm();
  });
  return order;
}

Eigen::Matrix3Xd spread_over(const elasticity::Body& body, int count) {
  const Eigen::Matrix3Xd& mesh = body.mesh.nodes;
  Eigen::Matrix3Xd nodes(3, count);
  nodes.col(0) = mesh.col(body.fixed_nodes.empty() ? 0 : body.fixed_nodes.front());
  Eigen::RowVectorXd squared = (mesh.colwise() - nodes.col(0)).colwise().squaredNorm();
  for (int k = 1; k < count; ++k) {
    Eigen::Index farthest = 0;
    squared.maxCoeff(&farthest);
    nodes.col(k) = mesh.col(farthest);
    squared = squared.cwiseMin((mesh.colwise() - nodes.col(k)).colwise().squaredNorm());
  }
  return nodes;
}

}  // namespace

DeformationGraph::DeformationGraph(const elasticity::Body& body, int nodes)
    : mesh_(body.mesh.nodes) {
  if (nodes <= std::max(kInfluences, kNeighbours) || nodes > mesh_.cols())
    throw std::invalid_argument("a deformation graph has 4 nodes or more, no more than its mesh");
  at_rest_ = spread_over(body, nodes);
  turn_.assign(nodes, Eigen::Matrix3d::Identity());
  shift_.setZero(3, nodes);
  for (const auto& p : mesh_.colwise()) {
    const std::vector<int> nearest = by_distance(at_rest_, p);
    const double end = (at_rest_.col(nearest[kInfluences]) - p).norm();
    Influence influence{};
    double sum = 0;
    for (int k = 0; k < kInfluences; ++k) {
      influence.nodes[k] = nearest[k];
      const double nearness = 1 - (at_rest_.col(nearest[k]) - p).norm() / end;
      sum += influence.weights[k] = nearness * nearness + 1e-9;
    }
    for (double& weight : influence.weights) weight /= sum;
    influences_.push_back(influence);
  }
  for (int a = 0; a < nodes; ++a) {
    const std::vector<int> nearest = by_distance(at_rest_, at_rest_.col(a));
    for (int k = 1; k <= kNeighbours; ++k) edges_.emplace_back(a, nearest[k]);
  }
}

Vector3d DeformationGraph::arm_to_mesh(int node, int mesh_node) const noexcept {
  return turn_[node] * (mesh_.col(mesh_node) - at_rest_.col(node));
}

Vector3d DeformationGraph::arm_to_node(int node, int other) const noexcept {
  return turn_[node] * (at_rest_.col(other) - at_rest_.col(node));
}

void DeformationGraph::reset() noexcept {
  for (Eigen::Matrix3d& turn : turn_) turn.setIdentity();
  shift_.setZero();
}

void DeformationGraph::move(int node, const Vector3d& turn, const Vector3d& shift) noexcept {
  const Eigen::Matrix3d turned = math::exp_rotation(turn) * turn_[node];
  turn_[node] = turned;
  shift_.col(node) += shift;
}

void DeformationGraph::draw(Eigen::Matrix3Xd& shape) const noexcept {
  for (Eigen::Index i = 0; i < mesh_.cols(); ++i) {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < kInfluences; ++k) {
      const int node = influences_[i].nodes[k];
      sum += influences_[i].weights[k] * (arm_to_mesh(node, static_cast<int>(i)) + place(node));
    }
    shape.col(i) = sum;
  }
}

}  // namespace palpate::baselines
