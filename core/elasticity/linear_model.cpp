#include "core/elasticity/linear_model.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/elasticity/element.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Linear elastic stiffness of a tetrahedron, 3 N x 3 N.
template <int kNodes>
void element_stiffness(const Eigen::Matrix<double, 3, 4>& corners, const Lame& lame,
                       Eigen::MatrixXd& K) {
  const auto gradients = Tetrahedron<kNodes>::gradients(corners);
  const double weight = tetrahedron_volume(corners) / static_cast<double>(gradients.size());
  K.setZero(3 * kNodes, 3 * kNodes);
  for (const auto& g : gradients) {
    for (int a = 0; a < kNodes; ++a) {
      for (int b = 0; b < kNodes; ++b) {
        const Matrix3d outer = weight * g.col(a) * g.col(b).transpose();
        K.block<3, 3>(3 * a, 3 * b) +=
            lame.lambda * outer +
            lame.mu * (outer.transpose() + outer.trace() * Matrix3d::Identity());
      }
    }
  }
}

/// Change of an affine motion A r + t when its hand moves by xi, where A is a rotation.
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
      pattern_(body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes),
      stiffness_(pattern_),
      nodal_mass_(Eigen::VectorXd::Zero(x_.cols())),
      rhs_(Eigen::Matrix4Xd::Zero(4, pattern_.size())) {
  for (Matrix3Xd* m : {&external_, &u_, &k_u_}) m->setZero(3, x_.cols());
  if (body_.mesh.order == mesh::ElementOrder::kLinear) {
    assemble<4>();
  } else {
    assemble<10>();
  }
}

template <int kNodes>
void LinearModel::assemble() {
  const Eigen::Matrix<double, kNodes, 1> shares = Tetrahedron<kNodes>::volume_shares();
  Eigen::MatrixXd K;
  for (int e = 0; e < body_.mesh.element_count(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = body_.mesh.nodes.col(body_.mesh.elements(a, e));
    const double volume = tetrahedron_volume(corners);
    if (!(volume > 0)) {
      throw std::invalid_argument("element " + std::to_string(e) + " has no positive volume");
    }
    const Material& material = body_.material_of(e);
    element_stiffness<kNodes>(corners, lame(material), K);
    stiffness_.add(e, K);
    for (int a = 0; a < kNodes; ++a) {
      nodal_mass_(body_.mesh.elements(a, e)) += material.density * volume * shares(a);
    }
  }
}

void LinearModel::prepare() {
  ComparisonModel::prepare();
  forget_sensitivity();
  const int grasps = static_cast<int>(body_.grasps.size());
  factors_.assign(std::size_t{1} << grasps, Factor(pattern_));
  for (std::size_t set = 0; set < factors_.size(); ++set) {
    Factor& factor = factors_[set];
    for (int g = 0; g < grasps; ++g) {
      if (!(set >> g & 1)) continue;
      for (int node : body_.grasps[g].nodes) factor.held[pattern_.unknown(node)] = 1;
    }
    factor.usable = factor.ldl.factorise(stiffness_, factor.held, 0);
    if (!factor.usable) continue;
    for (int g = 0; g < grasps; ++g) {
      if (set >> g & 1) respond(factor, g);
    }
  }
  for (int g = 0; g < grasps; ++g) spare_[g].resize(x_.size(), 6);
}

/// From the displacements of the given nodes in u_ and the loads in external_: those of the others,
/// and K u - loads in k_u_.
void LinearModel::solve(const Factor& factor) noexcept {
  stiffness_.multiply(u_, k_u_);
  for (int k = 0; k < pattern_.size(); ++k) {
    rhs_.col(k).setZero();
    const int node = pattern_.node(k);
    if (!factor.held[k]) rhs_.col(k).head<3>() = external_.col(node) - k_u_.col(node);
  }
  factor.ldl.solve(rhs_);
  for (int k = 0; k < pattern_.size(); ++k) {
    if (!factor.held[k]) u_.col(pattern_.node(k)) = rhs_.col(k).head<3>();
  }
  stiffness_.multiply(u_, k_u_);
  k_u_ -= external_;
}

void LinearModel::respond(Factor& factor, int grasp) {
  const GraspRegion& region = body_.grasps[grasp];
  Affine& shape = factor.shape[grasp];
  Affine& force = factor.force[grasp];
  shape.resize(x_.size(), 12);
  force.resize(3 * static_cast<int>(region.nodes.size()), 12);
  external_.setZero();
  for (int column = 0; column < 12; ++column) {
    u_.setZero();
    for (int node : region.nodes) {
      const Vector3d r = body_.mesh.nodes.col(node) - region.X_OG_rest.translation();
      u_(column % 3, node) = column < 3 ? 1 : r(column / 3 - 1);
    }
    solve(factor);
    shape.col(column) = Eigen::Map<const Eigen::VectorXd>(u_.data(), u_.size());
    int row = 0;
    for (int node : region.nodes) {
      force.block<3, 1>(row, column) = k_u_.col(node);
      row += 3;
    }
  }
}

StepReport LinearModel::advance(double) noexcept {
  StepReport report;
  if (factors_.empty()) return report;
  const Factor& factor = factors_[held_.held_set()];
  if (!factor.usable) return report;
  external_ = loads_;
  external_.noalias() += gravity_ * nodal_mass_.transpose();
  x_ = body_.mesh.nodes;
  held_.place(x_);
  u_ = x_ - body_.mesh.nodes;
  solve(factor);
  x_ = body_.mesh.nodes + u_;
  forces_ = k_u_;
  if (!x_.allFinite() || !forces_.allFinite()) return report;
  for (int k = 0; k < pattern_.size(); ++k) {
    if (!factor.held[k])
      report.residual = std::max(report.residual, k_u_.col(pattern_.node(k)).norm());
  }
  report.status = StepStatus::kConverged;
  report.iterations = 1;
  update_sensitivity(factor);
  return report;
}

void LinearModel::update_sensitivity(const Factor& factor) noexcept {
  forget_sensitivity();
  sensitivity_.valid = true;
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (!held_.is_held(static_cast<int>(g))) continue;
    const GraspRegion& region = body_.grasps[g];
    const Matrix3d A = held_.motion(static_cast<int>(g)).linear();
    const Eigen::Matrix<double, 12, 6> Z = rigid_motions(A);
    std::swap(sensitivity_.dx_dxi[g], spare_[g]);
    sensitivity_.dx_dxi[g].noalias() = factor.shape[g].lazyProduct(Z);
    math::Matrix6d& dw = sensitivity_.dw_dxi[g];
    int row = 0;
    for (int node : region.nodes) {
      const Eigen::Matrix<double, 3, 6> df = factor.force[g].middleRows<3>(row).lazyProduct(Z);
      const Matrix3d arm =
          math::cross_matrix(A * (body_.mesh.nodes.col(node) - region.X_OG_rest.translation()));
      dw.topRows<3>() += df;
      dw.bottomRows<3>() += arm * df;
      // The lever arm turns with the hand while the force stays.
      dw.bottomRightCorner<3, 3>() += math::cross_matrix(forces_.col(node)) * arm;
      row += 3;
    }
  }
}

/// Storage moves to spare_, since what is not held must be empty.
void LinearModel::forget_sensitivity() noexcept {
  sensitivity_.valid = false;
  for (int g = 0; g < 2; ++g) {
    if (sensitivity_.dx_dxi[g].rows() > 0) std::swap(sensitivity_.dx_dxi[g], spare_[g]);
    sensitivity_.dw_dxi[g].setZero();
  }
}

void LinearModel::release(int grasp) noexcept {
  if (is_held(grasp)) forget_sensitivity();
  ComparisonModel::release(grasp);
}

void LinearModel::reset() noexcept {
  ComparisonModel::reset();
  forget_sensitivity();
}

bool LinearModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (!ComparisonModel::restore(positions, velocities)) return false;
  v_.setZero();
  forget_sensitivity();
  return true;
}

}  // namespace palpate::elasticity
