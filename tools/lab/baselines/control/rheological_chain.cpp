#include "tools/lab/baselines/control/rheological_chain.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

constexpr int kNewton = 40;
constexpr double kLeastStep = 1e-8;  // m

Eigen::Vector3d middle_of(const elasticity::Body& body, const std::vector<int>& nodes) {
  return body.mesh.nodes(Eigen::all, nodes).rowwise().mean();
}

}  // namespace

RheologicalChain::RheologicalChain(const Options& options, const elasticity::Body& body, int grasp)
    : options_(options) {
  if (options.masses < 6 || options.masses > 60 || !(options.relaxation >= 0) ||
      !(options.relaxation_time > 0))
    throw std::invalid_argument("masses or relaxation of the chain are out of range");
  if (grasp < 0 || grasp >= static_cast<int>(body.grasps.size()) || body.fixed_nodes.empty())
    throw std::invalid_argument("a chain is held by a rig at one end and by a hand at the other");
  X_rest_ = body.grasps[grasp].X_OG_rest;
  const Eigen::Vector3d root = middle_of(body, body.fixed_nodes);
  const Eigen::Vector3d end = middle_of(body, body.grasps[grasp].nodes);
  const double length = (end - root).norm();
  if (!(length > 1e-3)) throw std::invalid_argument("the hand holds the object where the rig does");
  along_ = (end - root) / length;
  rest_.resize(3, options.masses);
  for (int i = 0; i < options.masses; ++i)
    rest_.col(i) = root + (end - root) * i / (options.masses - 1);
  link_ = length / (options.masses - 1);
  const Eigen::Vector3d size =
      body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff();
  int axis = 0;
  along_.cwiseAbs().maxCoeff(&axis);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double area = size[u] * size[v];
  // instantaneous stiffness of the object, that of both springs together
  const double spring = body.material.young_modulus / (1 + options.relaxation);
  stretching_ = spring * area / link_;
  const double by_moment = spring * area / 12 / std::pow(link_, 3);
  bending_[u] = by_moment * size[u] * size[u];
  bending_[v] = by_moment * size[v] * size[v];
  bending_[axis] = std::min(bending_[u], bending_[v]);
  weight_ = body.material.density * area * link_ * body.gravity_O;
  reset();
}

void RheologicalChain::reset() {
  x_ = rest_;
  stretch_crept_.setZero(count() - 1);
  bending_crept_.setZero(3, count());
  torsion_ = 0;
  // after a very long time the dashpots bear no load
  for (int i = 0; i < 4; ++i) step(X_rest_, 1e6 * options_.relaxation_time);
}

void RheologicalChain::set_ends(const math::Pose& X_OG) {
  const math::Pose moved = X_OG * X_rest_.inverse();
  const int n = count();
  for (const int i : {0, 1}) x_.col(i) = rest_.col(i);
  for (const int i : {n - 2, n - 1}) x_.col(i) = moved * rest_.col(i);
  // component of the hand's rotation that does not rotate the axis
  const Eigen::Vector3d to = moved.linear() * along_;
  const Eigen::Quaterniond swing = Eigen::Quaterniond::FromTwoVectors(along_, to);
  torsion_ = math::log_rotation(swing.toRotationMatrix().transpose() * moved.linear()).dot(along_);
}

double RheologicalChain::energy(double share) const {
  double sum = 0;
  for (int i = 0; i + 1 < count(); ++i) {
    const double e = stretch(i), dashed = e - stretch_crept_[i];
    sum += 0.5 * stretching_ * (e * e + share * dashed * dashed);
  }
  for (int i = 1; i + 1 < count(); ++i) {
    const Eigen::Vector3d b = curvature(i), dashed = b - bending_crept_.col(i);
    sum += 0.5 * bending_.dot(b.cwiseAbs2() + share * dashed.cwiseAbs2());
    sum -= weight_.dot(x_.col(i));
  }
  return sum;
}

void RheologicalChain::derivatives(double share, Eigen::VectorXd& gradient,
                                   Eigen::MatrixXd& hessian) const {
  const int n = count();
  gradient.setZero(3 * n);
  hessian.setZero(3 * n, 3 * n);
  for (int i = 0; i + 1 < n; ++i) {
    const Eigen::Vector3d way = x_.col(i + 1) - x_.col(i);
    const double length = std::max(1e-9, way.norm()), e = length - link_;
    const Eigen::Vector3d d = way / length;
    const double force = stretching_ * (e + share * (e - stretch_crept_[i]));
    // Compression destabilises links laterally; without this contribution the matrix remains
    // positive definite.
    const Eigen::Matrix3d K =
        stretching_ * (1 + share) * d * d.transpose() +
        std::max(0.0, force) / length * (Eigen::Matrix3d::Identity() - d * d.transpose());
    gradient.segment<3>(3 * i) -= force * d;
    gradient.segment<3>(3 * i + 3) += force * d;
    for (const int a : {0, 1})
      for (const int b : {0, 1})
        hessian.block<3, 3>(3 * (i + a), 3 * (i + b)) += (a == b ? 1 : -1) * K;
  }
  const double factor[3] = {1, -2, 1};
  for (int i = 1; i + 1 < n; ++i) {
    const Eigen::Vector3d b = curvature(i);
    const Eigen::Vector3d force = bending_.cwiseProduct(b + share * (b - bending_crept_.col(i)));
    for (int p = 0; p < 3; ++p) {
      gradient.segment<3>(3 * (i + p - 1)) += factor[p] * force;
      for (int q = 0; q < 3; ++q)
        hessian.block<3, 3>(3 * (i + p - 1), 3 * (i + q - 1)).diagonal() +=
            (1 + share) * factor[p] * factor[q] * bending_;
    }
    gradient.segment<3>(3 * i) -= weight_;
  }
}

bool RheologicalChain::step(const math::Pose& X_OG, double dt) {
  set_ends(X_OG);
  // Backward Euler for v' = (e - v) / time: the dashpot's spring acts about v, with reduced
  // stiffness.
  const double way = dt / options_.relaxation_time, share = options_.relaxation / (1 + way);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  bool converged = false;
  for (int i = 0; i < kNewton && !converged; ++i) {
    derivatives(share, gradient, hessian);
    const Eigen::VectorXd move = -hessian.block(6, 6, 3 * free_count(), 3 * free_count())
                                      .ldlt()
                                      .solve(gradient.segment(6, 3 * free_count()));
    if (!move.allFinite()) return false;
    const Eigen::Matrix3Xd before = x_;
    const double energy_before = energy(share);
    for (double factor = 1; factor > 1e-3; factor *= 0.5) {
      x_.middleCols(2, free_count()) =
          before.middleCols(2, free_count()) + factor * move.reshaped(3, free_count());
      if (energy(share) <= energy_before) break;
    }
    converged = move.cwiseAbs().maxCoeff() < kLeastStep;
  }
  for (int i = 0; i + 1 < count(); ++i)
    stretch_crept_[i] = (stretch_crept_[i] + way * stretch(i)) / (1 + way);
  for (int i = 1; i + 1 < count(); ++i)
    bending_crept_.col(i) = (bending_crept_.col(i) + way * curvature(i)) / (1 + way);
  return converged;
}

Eigen::VectorXd RheologicalChain::points(const std::vector<Eigen::Vector3d>& rest_points) const {
  Eigen::VectorXd values(3 * static_cast<Eigen::Index>(rest_points.size()));
  Eigen::Index row = 0;
  for (const Eigen::Vector3d& point : rest_points) {
    const double s = (point - rest_.col(0)).dot(along_) / link_;
    const int i = std::clamp(static_cast<int>(s), 0, count() - 2);
    const Eigen::Vector3d tangent = (x_.col(i + 1) - x_.col(i)).normalized();
    const double share = std::clamp(s / (count() - 1), 0.0, 1.0);
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(along_, tangent) *
                                    Eigen::Quaterniond(Eigen::AngleAxisd(share * torsion_, along_));
    const Eigen::Vector3d from = rest_.col(i) + (s - i) * link_ * along_;
    values.segment<3>(row) =
        x_.col(i) + (s - i) * (x_.col(i + 1) - x_.col(i)) + turn * (point - from);
    row += 3;
  }
  return values;
}

}  // namespace palpate::baselines
