#include "core/elasticity/comparison/mass_spring_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "core/math/option_check.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

std::vector<MassSpringModel::Spring> make_springs(const Body& body,
                                                  const std::vector<LinearPiece>& pieces) {
  std::map<std::pair<int, int>, MassSpringModel::Spring> springs;
  for (const LinearPiece& piece : pieces) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int k = 0; k < 4; ++k) corners.col(k) = body.mesh.nodes.col(piece.nodes[k]);
    const double scale =
        spring_share(corners) * body.material_of(piece.element).young_modulus * piece.volume;
    for (const auto& edge : mesh::kTetrahedronEdges) {
      const auto [a, b] = std::minmax(piece.nodes[edge[0]], piece.nodes[edge[1]]);
      const double length = (corners.col(edge[0]) - corners.col(edge[1])).norm();
      auto& spring =
          springs.try_emplace({a, b}, MassSpringModel::Spring{a, b, length, 0}).first->second;
      spring.stiffness += scale / (length * length);
    }
  }
  std::vector<MassSpringModel::Spring> all;
  for (const auto& entry : springs) all.push_back(entry.second);
  return all;
}

double dot(const Matrix3Xd& a, const Matrix3Xd& b) { return (a.array() * b.array()).sum(); }

}  // namespace

double spring_share(const Eigen::Matrix<double, 3, 4>& corners) {
  Eigen::Matrix<double, 3, 6> n;
  for (int e = 0; e < 6; ++e) {
    const auto& edge = mesh::kTetrahedronEdges[e];
    n.col(e) = (corners.col(edge[1]) - corners.col(edge[0])).normalized();
  }
  // n n : C : n n = lambda + 2 mu = 1.2 E in every direction for nu = 1/4
  const Eigen::Matrix<double, 6, 6> cosines = n.transpose() * n;
  return 6 * 1.2 / cosines.array().square().square().sum();
}

MassSpringModel::MassSpringModel(Body body, const MassSpringOptions& options)
    : ComparisonModel(std::move(body)), options_(options) {
  math::check_option(options.iterations >= 1, "iterations", options.iterations, "at least 1");
  math::check_option(options.cg_iterations >= 1, "cg_iterations", options.cg_iterations,
                     "at least 1");
  math::check_option(options.halvings >= 0, "halvings", options.halvings, "at least 0");
  math::check_option(options.tolerance > 0, "tolerance", options.tolerance, "above 0");
  const std::vector<LinearPiece> pieces = linear_pieces(body_.mesh);
  springs_ = make_springs(body_, pieces);
  masses_ = lumped_masses(body_, pieces);
  tensions_.resize(springs_.size());
  inverse_diagonal_.resize(masses_.size());
  for (Matrix3Xd* m : {&external_, &x_inertial_, &x_trial_, &dx_, &remainder_, &conditioned_,
                       &search_, &product_}) {
    m->setZero(3, x_.cols());
  }
}

double MassSpringModel::elastic_energy() const noexcept {
  double energy = 0;
  for (const Spring& s : springs_) {
    const double stretch = (x_.col(s.a) - x_.col(s.b)).norm() - s.length;
    energy += 0.5 * s.stiffness * stretch * stretch;
  }
  return energy;
}

void MassSpringModel::begin_step(double dt) noexcept {
  external_ = loads_;
  external_.noalias() += gravity_ * masses_.transpose();
  inertia_ = 1 / (dt * dt) + body_.damping.mass_factor / dt;
  x_inertial_ = x_begin_ + v_begin_ * (1 / (dt * inertia_));
  // k (l - l0)^2 / 2 + k viscous (l - l_begin)^2 / 2 is again one spring, plus a constant
  const double viscous = body_.damping.stiffness_factor / dt;
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& s = springs_[i];
    const double now = (x_begin_.col(s.a) - x_begin_.col(s.b)).norm();
    tensions_[i].stiffness = s.stiffness * (1 + viscous);
    tensions_[i].length = (s.length + viscous * now) / (1 + viscous);
  }
}

/// Incremental potential at x_, J; its derivative goes to forces_ and the tangents to tensions_.
double MassSpringModel::evaluate() noexcept {
  double energy = 0;
  for (int i = 0; i < x_.cols(); ++i) {
    const Vector3d off = x_.col(i) - x_inertial_.col(i);
    forces_.col(i) = inertia_ * masses_(i) * off - external_.col(i);
    energy += 0.5 * inertia_ * masses_(i) * off.squaredNorm() -
              external_.col(i).dot(x_.col(i) - body_.mesh.nodes.col(i));
  }
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& s = springs_[i];
    Tension& t = tensions_[i];
    t.direction = x_.col(s.a) - x_.col(s.b);
    const double length = t.direction.norm();
    t.direction /= std::max(length, 1e-9 * s.length);
    const double stretch = length - t.length;
    t.across = length > t.length ? t.stiffness * stretch / length : 0;
    energy += 0.5 * t.stiffness * stretch * stretch;
    const Vector3d force = t.stiffness * stretch * t.direction;
    forces_.col(s.a) += force;
    forces_.col(s.b) -= force;
  }
  return energy;
}

double MassSpringModel::residual() const noexcept {
  double largest = 0;
  for (int i = 0; i < x_.cols(); ++i) {
    if (!held_.is_given(i)) largest = std::max(largest, forces_.col(i).squaredNorm());
  }
  return std::sqrt(largest);
}

void MassSpringModel::precondition() noexcept {
  for (int i = 0; i < x_.cols(); ++i) {
    inverse_diagonal_[i] = inertia_ * masses_(i) * Matrix3d::Identity();
  }
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Tension& t = tensions_[i];
    Matrix3d block = (t.stiffness - t.across) * t.direction * t.direction.transpose();
    block.diagonal().array() += t.across;
    inverse_diagonal_[springs_[i].a] += block;
    inverse_diagonal_[springs_[i].b] += block;
  }
  for (Matrix3d& block : inverse_diagonal_) block = block.inverse().eval();
}

/// y = tangent times u over free nodes; u is zero at prescribed nodes.
void MassSpringModel::multiply(const Matrix3Xd& u, Matrix3Xd& y) const noexcept {
  for (int i = 0; i < u.cols(); ++i) y.col(i) = inertia_ * masses_(i) * u.col(i);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& s = springs_[i];
    const Tension& t = tensions_[i];
    const Vector3d d = u.col(s.a) - u.col(s.b);
    const Vector3d f = t.across * d + (t.stiffness - t.across) * t.direction.dot(d) * t.direction;
    y.col(s.a) += f;
    y.col(s.b) -= f;
  }
  for (int i = 0; i < u.cols(); ++i) {
    if (held_.is_given(i)) y.col(i).setZero();
  }
}

/// Solves tangent dx_ = -forces_ over the free nodes by preconditioned conjugate gradients, whose
/// iterates are descent directions however early they stop.
void MassSpringModel::solve() noexcept {
  precondition();
  dx_.setZero();
  for (int i = 0; i < x_.cols(); ++i) {
    if (held_.is_given(i)) {
      remainder_.col(i).setZero();
    } else {
      remainder_.col(i) = -forces_.col(i);
    }
  }
  const double enough = std::max(0.1 * options_.tolerance, 1e-3 * remainder_.norm());
  double power_before = 1;
  for (int k = 0; k < options_.cg_iterations && remainder_.norm() > enough; ++k) {
    for (int i = 0; i < x_.cols(); ++i) {
      conditioned_.col(i).noalias() = inverse_diagonal_[i] * remainder_.col(i);
    }
    const double power = dot(remainder_, conditioned_);
    if (k == 0) {
      search_ = conditioned_;
    } else {
      search_ = conditioned_ + (power / power_before) * search_;
    }
    power_before = power;
    multiply(search_, product_);
    const double alpha = power / dot(search_, product_);
    if (!std::isfinite(alpha)) return;
    dx_ += alpha * search_;
    remainder_ -= alpha * product_;
  }
}

StepReport MassSpringModel::advance(double dt) noexcept {
  StepReport report;
  begin_step(dt);
  x_ = x_begin_ + dt * v_begin_;
  held_.place(x_);
  double energy = evaluate();
  report.residual = residual();
  while (report.residual > options_.tolerance && report.iterations < options_.iterations) {
    solve();
    ++report.iterations;
    const double slope = dot(forces_, dx_);  // dx_ is zero at prescribed nodes
    x_trial_ = x_;
    const double begin = report.residual;
    bool accepted = false;
    double alpha = 1, next = energy;
    for (int halving = 0; halving <= options_.halvings && !accepted; ++halving, alpha *= 0.5) {
      x_ = x_trial_ + alpha * dx_;
      next = evaluate();
      report.residual = residual();
      // Near the minimum rounding errors of the energy exceed its decrease; there the residual
      // decides.
      const double rounding = 1e-12 * (std::abs(energy) + std::abs(next));
      accepted = next <= energy + 1e-4 * alpha * slope ||
                 (std::abs(next - energy) <= rounding && report.residual < begin);
    }
    if (!accepted) {
      x_ = x_trial_;
      evaluate();
      report.residual = begin;
      break;
    }
    energy = next;
  }
  v_ = (x_ - x_begin_) / dt;
  report.status =
      report.residual <= options_.tolerance ? StepStatus::kConverged : StepStatus::kNotConverged;
  return report;
}

}  // namespace palpate::elasticity
