#include "core/elasticity/incremental/column_refinement.hpp"

namespace palpate::elasticity {
namespace {

// Relative to the body's size: rounding errors in single precision stay below 1e-4.
constexpr double kMove = 2e-3;

}  // namespace

using Eigen::Matrix3d;
using Eigen::Vector3d;

TangentProduct::TangentProduct(const NumberedBody& body, Precision precision)
    : forces_(make_element_forces(body.body.mesh, body.elements.materials(), body.numbering,
                                  precision)),
      x_(NodalField::Zero(4, body.node_count())),
      forward_(x_),
      backward_(x_) {
  const Eigen::Matrix3Xd& nodes = body.body.mesh.nodes;
  const Vector3d size = nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff();
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

ColumnRefinement::ColumnRefinement(const NumberedBody& body, const BoundaryConditions& boundary,
                                   WarpedFactor& factor, TrackedSensitivity& sensitivity,
                                   Precision precision)
    : body_(body),
      boundary_(boundary),
      factor_(factor),
      sensitivity_(sensitivity),
      tangent_(body, precision),
      column_(NodalField::Zero(4, body.node_count())),
      correction_(Eigen::VectorXf::Zero(3 * body.pattern.size())) {}

void ColumnRefinement::refine_next(const NodalField& x) noexcept {
  if (!sensitivity_.at_snapshot().valid || !factor_.is_exact()) return;
  refined_ = (refined_ + 1) % 12;
  if (!boundary_.held()[refined_ / 6]) refined_ = (refined_ + 6) % 12;
  const int g = refined_ / 6, k = refined_ % 6;
  if (!boundary_.held()[g]) return;

  load_column(x, g, k);
  const NodalField& felt = tangent_.multiply(x, column_);
  for (int i = 0; i < body_.pattern.size(); ++i) {
    correction_.segment<3>(3 * i) = -felt.col(i).head<3>().cast<float>();
  }
  factor_.solve(correction_, boundary_);
  if (!correction_.allFinite()) return;
  for (int i = 0; i < body_.pattern.size(); ++i) {
    column_.col(i).head<3>() += correction_.segment<3>(3 * i).cast<double>();
  }
  sensitivity_.set_column(g, k, column_);
}

/// Sets column_ to the response to motion k of grasp g, rotated, with the nodes of held grasps
/// moved exactly.
void ColumnRefinement::load_column(const NodalField& x, int g, int k) noexcept {
  const int axis = k % 3, first = k - axis;
  const NodeWarp& warp = factor_.warp();
  const Matrix3d R = sensitivity_.hand_rotation(g);
  column_.setZero();
  for (int node = 0; node < body_.node_count(); ++node) {
    const int i = body_.numbering[node];
    if (i >= warp.size()) continue;
    const Vector3d then =
        sensitivity_.at_snapshot().dx_dxi[g].block<3, 3>(3 * node, first) * R.row(axis).transpose();
    column_.col(i).head<3>() = warp.matrix(i).cast<double>() * then;
  }
  for (int other = 0; other < body_.grasp_count(); ++other) {
    if (!boundary_.held()[other]) continue;
    for (int node : body_.body.grasps[other].nodes) {
      auto moved = column_.col(body_.numbering[node]).head<3>();
      moved.setZero();
      if (other != g) continue;
      const Vector3d r =
          x.col(body_.numbering[node]).head<3>() - boundary_.applied()[g].translation();
      moved = k < 3 ? Vector3d::Unit(axis) : Vector3d(Vector3d::Unit(axis).cross(r));
    }
  }
}

}  // namespace palpate::elasticity
