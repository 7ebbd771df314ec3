#include "core/elasticity/comparison/thesis2018.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

Body linear_body(Body body) {
  body.check();
  if (body.mesh.order != mesh::ElementOrder::kLinear) {
    throw std::invalid_argument("integrator thesis2018 needs linear tetrahedra");
  }
  return body;
}

}  // namespace

Thesis2018::Thesis2018(Body body, const Thesis2018Options& options)
    : body_(linear_body(std::move(body))),
      options_(options),
      system_(body_),
      gravity_(body_.gravity_O),
      x_(body_.mesh.nodes),
      rhs_(Eigen::MatrixXd::Zero(3 * system_.pattern.size(), 1)),
      element_matrix_(12, 12),
      element_mass_(4, 4) {
  if (!(options.time_step > 0)) throw std::invalid_argument("thesis2018: time step must be > 0");
  for (Matrix3Xd* m : {&loads_, &v_, &impulse_, &dv_, &product_, &reactions_}) {
    m->setZero(3, x_.cols());
  }
}

void Thesis2018::prepare() {
  reset();
  gravity_ = body_.gravity_O;
}

void Thesis2018::reset() noexcept {
  x_ = body_.mesh.nodes;
  v_.setZero();
  loads_.setZero();
  reactions_.setZero();
  is_held_ = {false, false};
  system_.forces.reset();
}

void Thesis2018::hold(int grasp, const math::Pose& X_OG) noexcept {
  X_OG_[grasp] = X_OG;
  is_held_[grasp] = true;
}

void Thesis2018::release(int grasp) noexcept { is_held_[grasp] = false; }

/// Assembles M + h D + h^2 K in system_.matrix, and h times the right-hand force in impulse_.
void Thesis2018::assemble() noexcept {
  const double h = options_.time_step;
  const Damping& damping = body_.damping;
  const double mass_share = 1 + h * damping.mass_factor;
  const double stiffness_share = h * damping.stiffness_factor + h * h;
  system_.forces.evaluate(x_, product_);  // becomes f_int + (D + h K) v
  system_.matrix.set_zero();
  for (int e = 0; e < system_.elements.element_count(); ++e) {
    system_.elements.stiffness(e, x_, Tangent::kWarped, 0, element_matrix_);
    system_.elements.mass(e, element_mass_);
    const auto nodes = body_.mesh.elements.col(e);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        product_.col(nodes(a)).noalias() += (damping.stiffness_factor + h) *
                                            element_matrix_.block<3, 3>(3 * a, 3 * b) *
                                            v_.col(nodes(b));
        product_.col(nodes(a)) += (damping.mass_factor * element_mass_(a, b)) * v_.col(nodes(b));
      }
    }
    element_matrix_ *= stiffness_share;
    system_.matrix.add(e, element_matrix_);
    system_.matrix.add_scalar(e, mass_share, element_mass_);
  }
  impulse_ = h * (loads_ - product_);
  impulse_.noalias() += h * gravity_ * system_.elements.nodal_mass().transpose();
}

StepReport Thesis2018::step(double) noexcept {
  StepReport report;
  bool finite = loads_.allFinite() && gravity_.allFinite();
  for (int g = 0; g < 2; ++g) finite = finite && (!is_held_[g] || X_OG_[g].matrix().allFinite());
  if (!finite) return report;

  const double h = options_.time_step;
  assemble();
  // grasped nodes reach their pose within the step
  dv_.setZero();
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (!is_held_[g]) continue;
    const math::Pose moved = X_OG_[g] * body_.grasps[g].X_OG_rest.inverse();
    for (int node : body_.grasps[g].nodes) {
      dv_.col(node) = (moved * body_.mesh.nodes.col(node) - x_.col(node)) / h - v_.col(node);
    }
  }
  system_.matrix.multiply(dv_, product_);
  for (int k = 0; k < system_.pattern.size(); ++k) {
    const int node = system_.pattern.node(k);
    rhs_.block<3, 1>(3 * k, 0) = impulse_.col(node) - product_.col(node);
  }
  if (!system_.factor.factorise(system_.matrix) || !system_.factor.is_positive(is_held_))
    return report;
  system_.factor.solve(rhs_, is_held_);
  if (!rhs_.allFinite()) return report;
  for (int k = 0; k < system_.pattern.size(); ++k) {
    if (system_.pattern.is_free(k, is_held_))
      dv_.col(system_.pattern.node(k)) = rhs_.block<3, 1>(3 * k, 0);
  }
  system_.matrix.multiply(dv_, product_);
  reactions_ = (product_ - impulse_) / h;
  v_ += dv_;
  x_ += h * v_;
  report.status = StepStatus::kConverged;
  report.iterations = 1;
  return report;
}

math::Wrench Thesis2018::reaction(int grasp) const noexcept {
  math::Wrench wrench;
  if (!is_held_[grasp]) return wrench;
  for (int node : body_.grasps[grasp].nodes) {
    wrench.force += reactions_.col(node);
    wrench.torque +=
        (x_.col(node) - X_OG_[grasp].translation()).cross(Vector3d(reactions_.col(node)));
  }
  return wrench;
}

bool Thesis2018::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  x_ = positions;
  v_ = velocities;
  for (int node : body_.fixed_nodes) {
    x_.col(node) = body_.mesh.nodes.col(node);
    v_.col(node).setZero();
  }
  return true;
}

}  // namespace palpate::elasticity
