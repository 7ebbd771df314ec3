#include "tools/lab/baselines/sensing/deformation_graph_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

constexpr double kClampDeviation = 2e-4;  // m
// m, length that makes rotations comparable with translations
constexpr double kArm = 0.05;
constexpr double kLargestStep = 0.02;  // m, limit of a translation, or of a rotation times kArm

}  // namespace

DeformationGraphFit::DeformationGraphFit(const elasticity::Body& body, const mesh::Surface& surface,
                                         const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      graph_(body, options.nodes),
      rest_(body.mesh.nodes),
      shape_(rest_),
      fixed_(body.fixed_nodes) {
  if (options.nodes > kMostNodes)
    throw std::invalid_argument("a deformation graph that is fitted has at most 20 nodes");
  if (!(options.deviation > 0) || !(options.rigidity > 0) || !(options.memory >= 0))
    throw std::invalid_argument("a deformation graph wants deviations > 0 and memory >= 0");
  if (options.hand)
    throw std::invalid_argument("a deformation graph does not take the pose of the hand");
  const int size = 6 * options.nodes;
  row_.setZero(size);
  vector_.setZero(size);
  information_.setZero(size, size);
}

void DeformationGraphFit::begin(const Eigen::Matrix3Xd&) noexcept {
  graph_.reset();
  graph_.draw(shape_);
}

void DeformationGraphFit::add_slope(int mesh_node, double weight, const Vector3d& n) noexcept {
  const DeformationGraph::Influence& by = graph_.influence(mesh_node);
  for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
    const int node = by.nodes[k];
    const double share = weight * by.weights[k];
    row_.segment<3>(6 * node) += share * graph_.arm_to_mesh(node, mesh_node).cross(n);
    row_.segment<3>(6 * node + 3) += share * n;
  }
}

void DeformationGraphFit::close_row(double residual) noexcept {
  for (Eigen::Index a = 0; a < row_.size(); ++a) {
    if (row_[a] == 0) continue;
    vector_[a] += row_[a] * residual;
    for (Eigen::Index b = 0; b <= a; ++b) information_(a, b) += row_[a] * row_[b];
  }
  row_.setZero();
}

void DeformationGraphFit::add_points() noexcept {
  for (int i = 0; i < matches().count(); ++i) {
    const CloudMatch& match = matches()[i];
    const Vector3d n = match.place.normal / options_.deviation;
    for (int k = 0; k < match.place.count; ++k)
      add_slope(match.place.nodes[k], match.place.weights[k], n);
    close_row(n.dot(match.point - match.of(shape_)));
  }
}

/// Each node's rotation and translation must predict the positions of its neighbours.
void DeformationGraphFit::add_edges() noexcept {
  for (const auto& [a, b] : graph_.edges()) {
    const Vector3d arm = graph_.arm_to_node(a, b);
    const Vector3d miss = graph_.place(b) - graph_.place(a) - arm;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d n = Vector3d::Unit(axis) / options_.rigidity;
      row_.segment<3>(6 * a) += arm.cross(n);
      row_.segment<3>(6 * a + 3) += n;
      row_.segment<3>(6 * b + 3) -= n;
      close_row(n.dot(miss));
    }
  }
}

void DeformationGraphFit::add_clamp() noexcept {
  for (const int node : fixed_) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d n = Vector3d::Unit(axis) / kClampDeviation;
      add_slope(node, 1, n);
      close_row(n.dot(rest_.col(node) - shape_.col(node)));
    }
  }
}

/// The previous shape acts as a prior, so that temporarily unobserved parts do not jump.
void DeformationGraphFit::add_memory() noexcept {
  const double kept = (options_.memory + 1e-6) / (options_.deviation * options_.deviation);
  for (int node = 0; node < graph_.size(); ++node) {
    information_.diagonal().segment<3>(6 * node).array() += kArm * kArm * kept;
    information_.diagonal().segment<3>(6 * node + 3).array() += kept;
  }
}

void DeformationGraphFit::take(elasticity::DeformationModel&) noexcept {
  information_.setZero();
  vector_.setZero();
  add_points();
  add_edges();
  add_clamp();
  add_memory();
  const Eigen::LDLT<Eigen::Ref<Square>> factor(information_);
  factor.solveInPlace(vector_);
  if (!vector_.allFinite()) return;
  double largest = 0;
  for (int node = 0; node < graph_.size(); ++node)
    largest = std::max({largest, kArm * vector_.segment<3>(6 * node).norm(),
                        vector_.segment<3>(6 * node + 3).norm()});
  const double share = largest > kLargestStep ? kLargestStep / largest : 1;
  for (int node = 0; node < graph_.size(); ++node)
    graph_.move(node, share * vector_.segment<3>(6 * node),
                share * vector_.segment<3>(6 * node + 3));
  graph_.draw(shape_);
}

elasticity::StepReport DeformationGraphFit::advance(double, const estimation::EstimationInputs&,
                                                    elasticity::DeformationModel& model) noexcept {
  return carry(shape_, model);
}

}  // namespace palpate::baselines
