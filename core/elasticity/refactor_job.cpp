#include "core/elasticity/refactor_job.hpp"

#include <algorithm>

namespace palpate::elasticity {
namespace {

// Relative to the body's size: rounding errors in single precision stay below 1e-4.
constexpr double kMove = 2e-3;

}  // namespace

SecantPairs::SecantPairs(int size) {
  for (Pair& pair : pairs_) {
    pair.step.setZero(size);
    pair.change.setZero(size);
  }
}

void SecantPairs::add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept {
  const float curvature = dot(step, change);
  if (!(curvature > 1e-5F * step.norm() * change.norm())) return;
  Pair& pair = pairs_[next_];
  pair.step = step;
  pair.change = change;
  pair.scale = 1 / curvature;
  next_ = (next_ + 1) % kPairs;
  count_ = std::min(count_ + 1, kPairs);
}

RefactorJob::RefactorJob(const Body& body, const ElementSet& elements,
                         const factor::Supernodes& supernodes, factor::PanelPrecision precision,
                         math::Team& team)
    : factor(supernodes, precision, team),
      pattern_(supernodes.pattern()),
      tangents_(make_element_tangents(elements, pattern_)),
      matrix_(pattern_),
      warped_(pattern_),
      mass_(mass_blocks(elements, pattern_)),
      factorisation_(supernodes),
      response_(body, elements, pattern_),
      stress_(make_stress_evaluator(elements)) {
  snapshot.positions = body.mesh.nodes;
  snapshot.loads.setZero(3, body.mesh.node_count());
  sensitivity.resize(body.mesh.node_count());
}

/// Assembles the static tangent and the matrix of the damping.
void RefactorJob::assemble(Tangent kind) {
  tangents_->assemble(snapshot.positions, kind, matrix_,
                      factor.step.viscous > 0 ? &warped_ : nullptr);
}

/// Converts the static tangent to that of a step.
void RefactorJob::add_step() {
  if (factor.step.viscous > 0) matrix_.add(factor.step.viscous, warped_);
  if (factor.step.inertia > 0) matrix_.add_scalar(factor.step.inertia, mass_);
}

bool RefactorJob::factorise(double shift) {
  return factorisation_.factorise(matrix_, shift) && factorisation_.is_positive(snapshot.held);
}

void RefactorJob::run() noexcept {
  sensitivity.valid = false;
  factor.regularised = false;
  stress_->evaluate(snapshot.positions, sensitivity.stress);
  assemble(Tangent::kExact);
  factor.exact = factorise();
  if (factor.exact) response_.compute(snapshot, matrix_, factorisation_, sensitivity);
  if (factor.step.inertia > 0) {
    add_step();
    factor.exact = factorise();
  }
  factor.usable = factor.exact;
  if (!factor.usable) {
    assemble(Tangent::kSemidefinite);
    add_step();
    factor.usable = factorise();
  }
  if (!factor.usable) {
    // The body is unsupported: a weak spring at every node replaces the support.
    double largest = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      largest = std::max(largest, matrix_.block(pattern_.column_start()[k]).trace() / 3);
    }
    factor.regularised = true;
    factor.usable = factorise(1e-4 * largest);
  }
  factor.usable = factor.usable && factor.panels.assign(factorisation_);
}

TangentProduct::TangentProduct(const Body& body, const std::vector<Lame>& materials,
                               const std::vector<int>& numbering, Precision precision)
    : forces_(make_element_forces(body.mesh, materials, numbering, precision)),
      x_(NodalField::Zero(4, body.mesh.node_count())),
      forward_(x_),
      backward_(x_) {
  const Eigen::Vector3d size =
      body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff();
  move_ = kMove * size.maxCoeff();
}

const NodalField& TangentProduct::multiply(const NodalField& x, const NodalField& column) noexcept {
  const double largest = column.cwiseAbs().maxCoeff();
  forward_.setZero();
  if (!(largest > 0)) return forward_;
  const double step = move_ / largest;
  backward_.setZero();
  x_ = x + step * column;
  forces_->add(x_, 0, forward_);
  x_ = x - step * column;
  forces_->add(x_, 0, backward_);
  forward_ = (forward_ - backward_) / (2 * step);
  return forward_;
}

}  // namespace palpate::elasticity
