#include "core/elasticity/thesis2018.hpp"

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
      elements_(body_),
      pattern_(body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes, patches(body_)),
      supernodes_(pattern_),
      matrix_(pattern_),
      factor_(supernodes_),
      forces_of_elements_(make_element_forces(elements_.mesh(), elements_.materials(),
                                              mesh_numbering(elements_.mesh()),
                                              Precision::kDouble)),
      padded_x_(NodalField::Zero(4, elements_.mesh().node_count())),
      padded_forces_(padded_x_),
      gravity_(body_.gravity_O),
      x_(body_.mesh.nodes),
      rhs_(Eigen::MatrixXd::Zero(3 * pattern_.size(), 1)),
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
  forces_of_elements_->reset();
}

void Thesis2018::hold(int grasp, const math::Pose& X_OG) noexcept {
  X_OG_[grasp] = X_OG;
  is_held_[grasp] = true;
}

void Thesis2018::release(int grasp) noexcept { is_held_[grasp] = false; }

/// M + h D + h^2 K into matrix_, and h times the force on the right into impulse_.
void Thesis2018::assemble() noexcept {
  const double h = options_.time_step;
  const Damping& damping = body_.damping;
  const double mass_share = 1 + h * damping.mass_factor;
  const double stiffness_share = h * damping.stiffness_factor + h * h;
  padded_x_.topRows<3>() = x_;
  padded_forces_.setZero();
  forces_of_elements_->add(padded_x_, 0, padded_forces_);
  product_ = padded_forces_.topRows<3>();  // f_int + (D + h K) v
  matrix_.set_zero();
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.stiffness(e, x_, Tangent::kWarped, 0, element_matrix_);
    elements_.mass(e, element_mass_);
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
    matrix_.add(e, element_matrix_);
    matrix_.add_scalar(e, mass_share, element_mass_);
  }
  impulse_ = h * (loads_ - product_);
  impulse_.noalias() += h * gravity_ * elements_.nodal_mass().transpose();
}

StepReport Thesis2018::step(double) noexcept {
  StepReport report;
  bool finite = loads_.allFinite() && gravity_.allFinite();
  for (int g = 0; g < 2; ++g) finite = finite && (!is_held_[g] || X_OG_[g].matrix().allFinite());
  if (!finite) return report;

  const double h = options_.time_step;
  assemble();
  // Grasped nodes reach their place within the step.
  dv_.setZero();
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (!is_held_[g]) continue;
    const math::Pose moved = X_OG_[g] * body_.grasps[g].X_OG_rest.inverse();
    for (int node : body_.grasps[g].nodes) {
      dv_.col(node) = (moved * body_.mesh.nodes.col(node) - x_.col(node)) / h - v_.col(node);
    }
  }
  matrix_.multiply(dv_, product_);
  for (int k = 0; k < pattern_.size(); ++k) {
    const int node = pattern_.node(k);
    rhs_.block<3, 1>(3 * k, 0) = impulse_.col(node) - product_.col(node);
  }
  if (!factor_.factorise(matrix_) || !factor_.is_positive(is_held_)) return report;
  factor_.solve(rhs_, is_held_);
  if (!rhs_.allFinite()) return report;
  for (int k = 0; k < pattern_.size(); ++k) {
    if (pattern_.is_free(k, is_held_)) dv_.col(pattern_.node(k)) = rhs_.block<3, 1>(3 * k, 0);
  }
  matrix_.multiply(dv_, product_);
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
