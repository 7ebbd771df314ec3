#include "core/elasticity/refactor_job.hpp"

namespace palpate::elasticity {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

RefactorJob::RefactorJob(const ElementSet& elements, const BlockPattern& pattern,
                         const std::vector<GraspRegion>& grasps)
    : positions(elements.mesh().nodes),
      external(Matrix3Xd::Zero(3, pattern.node_count())),
      factor(pattern, elements),
      elements_(elements),
      pattern_(pattern),
      grasps_(grasps),
      matrix_(pattern),
      state_(elements.make_state()),
      forces_(external),
      u_(external),
      k_u_(external),
      rhs_(Eigen::Matrix4Xd::Zero(4, pattern.size())) {}

void RefactorJob::assemble(Tangent kind, const StepFactors& step) {
  matrix_.set_zero();
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.stiffness(e, positions, kind, step.viscous, element_matrix_);
    matrix_.add(e, element_matrix_);
    if (step.inertia > 0) {
      elements_.mass(e, element_matrix_);
      matrix_.add_scalar(e, step.inertia, element_matrix_);
    }
  }
}

bool RefactorJob::factorise(Tangent kind, const StepFactors& step) {
  assemble(kind, step);
  return factor.ldl.factorise(matrix_, factor.held, 0);
}

void RefactorJob::run() noexcept {
  sensitivity.valid = false;
  sensitivity.age = 0;
  factor.exact = factor.usable = factorise(Tangent::kExact, {});
  factor.regularised = false;
  if (factor.usable) {
    forces_ = -external;
    elements_.add_forces(positions, 0, state_, forces_);
    for (int g = 0; g < static_cast<int>(grasps_.size()); ++g) respond(g);
    sensitivity.valid = true;
  }
  const bool dynamic = factor.step.inertia > 0;
  if (dynamic) factor.exact = factor.usable = factorise(Tangent::kExact, factor.step);
  if (!factor.usable) factor.usable = factorise(Tangent::kSemidefinite, factor.step);
  if (!factor.usable) {
    // Nothing holds the body: a weak spring at every node takes the place of the missing support.
    double largest = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      largest = std::max(largest, matrix_.block(pattern_.column_start()[k]).trace() / 3);
    }
    factor.usable = factor.ldl.factorise(matrix_, factor.held, 1e-4 * largest);
    factor.regularised = true;
  }
}

// x_f' = -K_ff^-1 K_fg G and w' = G^T (K_gg - K_gf K_ff^-1 K_fg) G + d(G^T)/dxi f_g, with
// G = [1, -[r]x] at each node of the patch, r from the origin of the grasp.
void RefactorJob::respond(int grasp) {
  auto& dx = sensitivity.dx_dxi[grasp];
  auto& dw = sensitivity.dw_dxi[grasp];
  dw.setZero();
  if (!is_held[grasp]) {
    dx.resize(0, 6);
    return;
  }
  const std::vector<int>& patch = grasps_[grasp].nodes;
  dx.resize(3 * pattern_.node_count(), 6);
  for (int column = 0; column < 6; ++column) {
    u_.setZero();
    const Vector3d axis = Vector3d::Unit(column % 3);
    for (int node : patch) {
      const Vector3d r = positions.col(node) - origins[grasp];
      u_.col(node) = column < 3 ? axis : Vector3d(axis.cross(r));
    }
    matrix_.multiply(u_, k_u_);
    for (int k = 0; k < pattern_.size(); ++k) {
      rhs_.col(k).setZero();
      if (!factor.held[k]) rhs_.col(k).head<3>() = -k_u_.col(pattern_.node(k));
    }
    factor.ldl.solve(rhs_);
    for (int k = 0; k < pattern_.size(); ++k) {
      if (!factor.held[k]) u_.col(pattern_.node(k)) = rhs_.col(k).head<3>();
    }
    dx.col(column) = Eigen::Map<const Eigen::VectorXd>(u_.data(), u_.size());
    matrix_.multiply(u_, k_u_);
    for (int node : patch) {
      const Vector3d r = positions.col(node) - origins[grasp];
      dw.col(column).head<3>() += k_u_.col(node);
      dw.col(column).tail<3>() += r.cross(k_u_.col(node));
      // The lever arm turns with the hand while the force stays.
      if (column >= 3) dw.col(column).tail<3>() += axis.cross(r).cross(forces_.col(node));
    }
  }
}

}  // namespace palpate::elasticity
