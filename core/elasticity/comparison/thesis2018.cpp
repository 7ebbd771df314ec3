#include "core/elasticity/comparison/thesis2018.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;

Body linear_body(Body body) {
  if (body.mesh.order != mesh::ElementOrder::kLinear) {
    throw std::invalid_argument("integrator thesis2018 needs linear tetrahedra");
  }
  return body;
}

}  // namespace

Thesis2018::Thesis2018(Body body)
    : ComparisonModel(linear_body(std::move(body))),
      system_(body_),
      rhs_(Eigen::MatrixXd::Zero(3 * system_.pattern.size(), 1)),
      element_matrix_(12, 12),
      element_mass_(4, 4) {
  for (Matrix3Xd* m : {&impulse_, &dv_, &product_}) {
    m->setZero(3, x_.cols());
  }
}

void Thesis2018::reset() noexcept {
  ComparisonModel::reset();
  system_.forces.reset();
}

/// Assembles M + h D + h^2 K in system_.matrix, and h times the right-hand force in impulse_.
void Thesis2018::assemble() noexcept {
  const double h = kTimeStep;
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

StepReport Thesis2018::advance(double) noexcept {
  StepReport report;
  const factor::Held held{held_.is_held(0), held_.is_held(1)};
  const double h = kTimeStep;
  assemble();
  // grasped nodes reach their pose within the step
  dv_.setZero();
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (!held[g]) continue;
    const math::Pose moved = held_.motion(static_cast<int>(g));
    for (int node : body_.grasps[g].nodes) {
      dv_.col(node) = (moved * body_.mesh.nodes.col(node) - x_.col(node)) / h - v_.col(node);
    }
  }
  system_.matrix.multiply(dv_, product_);
  for (int k = 0; k < system_.pattern.size(); ++k) {
    const int node = system_.pattern.node(k);
    rhs_.block<3, 1>(3 * k, 0) = impulse_.col(node) - product_.col(node);
  }
  if (!system_.factor.factorise(system_.matrix) || !system_.factor.is_positive(held)) return report;
  system_.factor.solve(rhs_, held);
  if (!rhs_.allFinite()) return report;
  for (int k = 0; k < system_.pattern.size(); ++k) {
    if (system_.pattern.is_free(k, held))
      dv_.col(system_.pattern.node(k)) = rhs_.block<3, 1>(3 * k, 0);
  }
  system_.matrix.multiply(dv_, product_);
  forces_ = (product_ - impulse_) / h;
  v_ += dv_;
  x_ += h * v_;
  report.status = StepStatus::kConverged;
  report.iterations = 1;
  return report;
}

}  // namespace palpate::elasticity
