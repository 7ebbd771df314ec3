#include "core/elasticity/comparison/linear_model.hpp"

#include <algorithm>
#include <utility>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Derivative of an affine motion A r + t with respect to the hand's motion xi, for a rotation A.
Eigen::Matrix<double, 12, 6> rigid_motions(const Matrix3d& A) {
  Eigen::Matrix<double, 12, 6> Z = Eigen::Matrix<double, 12, 6>::Zero();
  Z.topLeftCorner<3, 3>().setIdentity();
  for (int j = 0; j < 3; ++j) {
    Z.block<3, 3>(3 + 3 * j, 3) = -math::cross_matrix(A.col(j));
  }
  return Z;
}

}  // namespace

LinearModel::LinearModel(Body body)
    : ComparisonModel(std::move(body)),
      elements_(body_),
      pattern_(body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes, patches(body_)),
      supernodes_(pattern_),
      stiffness_(pattern_),
      factor_(supernodes_),
      rhs_(Eigen::MatrixXd::Zero(3 * pattern_.size(), 1)) {
  for (Matrix3Xd* m : {&external_, &u_, &k_u_}) m->setZero(3, x_.cols());
  Eigen::MatrixXd K;
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.stiffness(e, body_.mesh.nodes, Tangent::kWarped, 0, K);
    stiffness_.add(e, K);
  }
}

void LinearModel::prepare() {
  ComparisonModel::prepare();
  sensitivity_.resize(body_.mesh.node_count());
  sensitivity_.valid = false;
  prepared_ = factor_.factorise(stiffness_);
  const int grasps = static_cast<int>(body_.grasps.size());
  for (unsigned set = 0; prepared_ && set < (1u << grasps); ++set) {
    const factor::Held held{(set & 1) != 0, (set & 2) != 0};
    for (int g = 0; g < grasps; ++g) {
      if (held[g] && factor_.is_positive(held)) respond(held, g, responses_[set]);
    }
  }
}

/// Given the displacements of the prescribed nodes in u_ and the loads in external_, computes those
/// of the other nodes, and K u - loads in k_u_.
void LinearModel::solve(factor::Held held) noexcept {
  stiffness_.multiply(u_, k_u_);
  for (int k = 0; k < pattern_.size(); ++k) {
    const int node = pattern_.node(k);
    rhs_.col(0).segment<3>(3 * k) = external_.col(node) - k_u_.col(node);
  }
  factor_.solve(rhs_, held);
  for (int k = 0; k < pattern_.size(); ++k) {
    u_.col(pattern_.node(k)) += rhs_.col(0).segment<3>(3 * k);
  }
  stiffness_.multiply(u_, k_u_);
  k_u_ -= external_;
}

void LinearModel::respond(factor::Held held, int grasp, Response& response) {
  const GraspRegion& region = body_.grasps[grasp];
  response.shape[grasp].resize(x_.size(), 12);
  external_.setZero();
  for (int column = 0; column < 12; ++column) {
    u_.setZero();
    for (int node : region.nodes) {
      const Vector3d r = body_.mesh.nodes.col(node) - region.X_OG_rest.translation();
      u_(column % 3, node) = column < 3 ? 1 : r(column / 3 - 1);
    }
    solve(held);
    response.shape[grasp].col(column) = Eigen::Map<const Eigen::VectorXd>(u_.data(), u_.size());
    for (std::size_t a = 0; a < body_.grasps.size(); ++a) {
      const std::vector<int>& patch = body_.grasps[a].nodes;
      Affine& force = response.force[a][grasp];
      if (column == 0) force.resize(3 * static_cast<int>(patch.size()), 12);
      int row = 0;
      for (int node : patch) {
        force.block<3, 1>(row, column) = k_u_.col(node);
        row += 3;
      }
    }
  }
}

StepReport LinearModel::advance(double) noexcept {
  StepReport report;
  if (!prepared_ || !factor_.is_positive(held())) return report;
  external_ = loads_;
  external_.noalias() += gravity_ * elements_.nodal_mass().transpose();
  x_ = body_.mesh.nodes;
  held_.place(x_);
  u_ = x_ - body_.mesh.nodes;
  solve(held());
  x_ = body_.mesh.nodes + u_;
  forces_ = k_u_;
  if (!x_.allFinite() || !forces_.allFinite()) return report;
  for (int k = 0; k < pattern_.size(); ++k) {
    if (!pattern_.is_free(k, held())) continue;
    report.residual = std::max(report.residual, k_u_.col(pattern_.node(k)).norm());
  }
  report.status = StepStatus::kConverged;
  report.iterations = 1;
  update_sensitivity(responses_[held_.held_set()]);
  return report;
}

void LinearModel::update_sensitivity(const Response& response) noexcept {
  sensitivity_.valid = true;
  for (int g = 0; g < static_cast<int>(body_.grasps.size()); ++g) {
    if (!held_.is_held(g)) continue;
    const Eigen::Matrix<double, 12, 6> Z = rigid_motions(held_.motion(g).linear());
    sensitivity_.dx_dxi[g].noalias() = response.shape[g].lazyProduct(Z);
    for (int a = 0; a < static_cast<int>(body_.grasps.size()); ++a) {
      if (!held_.is_held(a)) continue;
      const GraspRegion& region = body_.grasps[a];
      math::Matrix6d& dw = sensitivity_.dw_dxi[a][g];
      dw.setZero();
      int row = 0;
      for (int node : region.nodes) {
        const Eigen::Matrix<double, 3, 6> df =
            response.force[a][g].middleRows<3>(row).lazyProduct(Z);
        const Matrix3d arm =
            math::cross_matrix(held_.motion(a).linear() *
                               (body_.mesh.nodes.col(node) - region.X_OG_rest.translation()));
        dw.topRows<3>() += df;
        dw.bottomRows<3>() += arm * df;
        // the lever arm rotates with the hand while the force is constant
        if (a == g) dw.bottomRightCorner<3, 3>() += math::cross_matrix(forces_.col(node)) * arm;
        row += 3;
      }
    }
  }
}

void LinearModel::release(int grasp) noexcept {
  if (is_held(grasp)) sensitivity_.valid = false;
  ComparisonModel::release(grasp);
}

void LinearModel::reset() noexcept {
  ComparisonModel::reset();
  sensitivity_.valid = false;
}

bool LinearModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (!ComparisonModel::restore(positions, velocities)) return false;
  v_.setZero();
  sensitivity_.valid = false;
  return true;
}

}  // namespace palpate::elasticity
