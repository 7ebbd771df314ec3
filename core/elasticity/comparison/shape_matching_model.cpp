#include "core/elasticity/comparison/shape_matching_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/elasticity/comparison/lumped_body.hpp"
#include "core/math/option_check.hpp"
#include "core/math/polar.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Nodes within a number of rings of edges of each node, including the node itself, in ascending
/// order.
std::vector<std::set<int>> neighbourhoods(const std::vector<LinearPiece>& pieces, int node_count,
                                          int rings) {
  std::vector<std::set<int>> near(node_count);
  for (const LinearPiece& piece : pieces) {
    for (int node : piece.nodes) near[node].insert(piece.nodes.begin(), piece.nodes.end());
  }
  std::vector<std::set<int>> reached = near;
  for (int ring = 1; ring < rings; ++ring) {
    std::vector<std::set<int>> next = reached;
    for (int i = 0; i < node_count; ++i) {
      for (int k : reached[i]) next[i].insert(near[k].begin(), near[k].end());
    }
    reached = std::move(next);
  }
  return reached;
}

/// Twice the energy stored by a region with k = 1 and this moment (kg m^2), summed over six
/// orthonormal strains, each with its best-fitting rotation. Equals 2 J if all axes are equal.
double resistance(const Matrix3d& moment) {
  const Vector3d a = Eigen::SelfAdjointEigenSolver<Matrix3d>(moment).eigenvalues();
  double sum = a.sum();
  for (int i = 0; i < 3; ++i) {
    const double p = a(i), q = a((i + 1) % 3);
    sum += 2 * p * q / (p + q);
  }
  return sum;
}

}  // namespace

ShapeMatchingModel::ShapeMatchingModel(Body body, const ShapeMatchingOptions& options)
    : ComparisonModel(std::move(body)), options_(options) {
  math::check_option(options.rings >= 1 && options.rings <= 5, "rings", options.rings, "1 to 5");
  math::check_option(options.max_substeps >= 1, "max_substeps", options.max_substeps, "at least 1");
  const std::vector<LinearPiece> pieces = linear_pieces(body_.mesh);
  const int n = body_.mesh.node_count();
  masses_ = lumped_masses(body_, pieces);
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(n), volume_modulus = volume;  // m^3, Pa m^3
  for (const LinearPiece& piece : pieces) {
    for (int node : piece.nodes) {
      volume(node) += piece.volume / 4;
      volume_modulus(node) += piece.volume / 4 * body_.material_of(piece.element).young_modulus;
    }
  }

  const std::vector<std::set<int>> near = neighbourhoods(pieces, n, options.rings);
  // a node belongs to as many regions as its own has members, because neighbourhood is symmetric
  for (const std::set<int>& nodes : near) {
    Region region;
    region.begin = static_cast<int>(members_.size());
    region.mass = 0;
    Vector3d centre = Vector3d::Zero();
    double stiffness_volume = 0;
    for (int node : nodes) {
      const double weight = 1.0 / static_cast<double>(near[node].size());
      members_.push_back({node, weight, weight * masses_(node), body_.mesh.nodes.col(node)});
      region.mass += members_.back().mass;
      centre += members_.back().mass * members_.back().rest;
      stiffness_volume += weight * volume_modulus(node);
    }
    centre /= region.mass;
    region.end = static_cast<int>(members_.size());
    Matrix3d moment = Matrix3d::Zero();
    for (int m = region.begin; m < region.end; ++m) {
      Member& member = members_[m];
      member.rest -= centre;
      moment += member.mass * member.rest * member.rest.transpose();
    }
    region.scale = 3 / moment.trace();
    region.stiffness = 6 * stiffness_volume / resistance(moment);
    stiffest_ = std::max(stiffest_, region.stiffness);
    regions_.push_back(region);
  }
  for (Matrix3Xd* m : {&x_target_, &x_before_, &acceleration_, &correction_}) m->setZero(3, n);
}

int ShapeMatchingModel::substeps(double dt) const noexcept {
  const double wanted = std::ceil(dt * std::sqrt(stiffest_));
  return wanted < options_.max_substeps ? std::max(1, static_cast<int>(wanted))
                                        : options_.max_substeps;
}

double ShapeMatchingModel::modulus_share(double dt) const noexcept {
  const double h = dt / substeps(dt);
  return std::min(1.0, 1 / (stiffest_ * h * h));
}

/// Mean correction of each node at x_ over its regions, into correction_. A correction c
/// corresponds to the force m c / square; square in s^2.
void ShapeMatchingModel::correct(double square) noexcept {
  correction_.setZero();
  for (Region& region : regions_) {
    Vector3d centre = Vector3d::Zero();
    for (int m = region.begin; m < region.end; ++m) {
      centre += members_[m].mass * x_.col(members_[m].node);
    }
    centre /= region.mass;
    Matrix3d moment = Matrix3d::Zero();
    for (int m = region.begin; m < region.end; ++m) {
      const Member& member = members_[m];
      moment +=
          (x_.col(member.node) - centre) * (region.scale * member.mass * member.rest).transpose();
    }
    const Matrix3d R = math::polar_rotation(moment, region.rotation);
    const double alpha = std::min(1.0, region.stiffness * square);
    for (int m = region.begin; m < region.end; ++m) {
      const Member& member = members_[m];
      correction_.col(member.node) +=
          alpha * member.weight * (centre + R * member.rest - x_.col(member.node));
    }
  }
}

void ShapeMatchingModel::reset() noexcept {
  ComparisonModel::reset();
  for (Region& region : regions_) region.rotation.setIdentity();
}

StepReport ShapeMatchingModel::advance(double dt) noexcept {
  const int count = substeps(dt);
  const double h = dt / count;
  const double decay = 1 / (1 + h * body_.damping.mass_factor);
  x_target_ = x_begin_;
  held_.place(x_target_);
  forces_.setZero();
  for (int i = 0; i < x_.cols(); ++i) acceleration_.col(i) = gravity_ + loads_.col(i) / masses_(i);

  for (int step = 1; step <= count; ++step) {
    x_before_ = x_;
    for (int i = 0; i < x_.cols(); ++i) {
      if (held_.is_given(i)) {
        x_.col(i) += (x_target_.col(i) - x_.col(i)) / (count - step + 1);
      } else {
        x_.col(i) += h * decay * (v_.col(i) + h * acceleration_.col(i));
      }
    }
    correct(h * h * decay);
    for (int i = 0; i < x_.cols(); ++i) {
      if (!held_.is_given(i)) {
        x_.col(i) += correction_.col(i);
        v_.col(i) = (x_.col(i) - x_before_.col(i)) / h;
        continue;
      }
      // force left to the hand by regions, loads, damping and inertia, averaged over dt
      const Vector3d velocity = (x_.col(i) - x_before_.col(i)) / h;
      forces_.col(i) += masses_(i) / count *
                        ((velocity / decay - v_.col(i)) / h - acceleration_.col(i) -
                         correction_.col(i) / (h * h * decay));
      v_.col(i) = velocity;
    }
  }
  StepReport report;
  report.status = StepStatus::kConverged;
  report.iterations = count;
  return report;
}

}  // namespace palpate::elasticity
