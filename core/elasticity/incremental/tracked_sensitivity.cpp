#include "core/elasticity/incremental/tracked_sensitivity.hpp"

#include <algorithm>
#include <utility>

namespace palpate::elasticity {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TrackedSensitivity::TrackedSensitivity(const NumberedBody& body, const BoundaryConditions& boundary,
                                       const NodeWarp& warp, int free_directions)
    : body_(body), boundary_(boundary), warp_(warp) {
  published_.resize(body.node_count(), free_directions);
  at_snapshot_.resize(body.node_count(), free_directions);
}

void TrackedSensitivity::install(Sensitivity& computed, const std::array<math::Pose, 2>& grasps,
                                 double age) noexcept {
  std::swap(at_snapshot_, computed);
  std::swap(published_.stress, at_snapshot_.stress);
  grasps_ = grasps;
  published_.valid = at_snapshot_.valid;
  published_.age = age;
  turn(0, 1);
}

Matrix3d TrackedSensitivity::hand_rotation(int grasp) const noexcept {
  return boundary_.applied()[grasp].linear() * grasps_[grasp].linear().transpose();
}

void TrackedSensitivity::turn(int part, int parts) noexcept {
  if (!at_snapshot_.valid) return;
  Turned turned{warp_, body_.numbering};
  for (int g = 0; g < 2; ++g) {
    turned.is_held[g] = boundary_.held()[g];
    turned.grasps[g] = hand_rotation(g);
  }
  for (int c = 0; c < kContactSlots; ++c) {
    // the node with the largest weight determines the rotation of a contact
    const mesh::PointWeights& point = contacts_[c];
    const auto* largest =
        std::max_element(point.weights.begin(), point.weights.begin() + point.count);
    const int k =
        point.count > 0 ? body_.numbering[point.nodes[largest - point.weights.begin()]] : -1;
    turned.is_watched[c] = point.count > 0;
    turned.contacts[c].setIdentity();
    if (k >= 0 && k < warp_.size()) turned.contacts[c] = warp_.matrix(k).cast<double>();
  }
  const int n = body_.node_count();
  elasticity::turn(at_snapshot_, turned, n * part / parts, n * (part + 1) / parts, published_);
}

void TrackedSensitivity::set_column(int g, int k, const NodalField& column) noexcept {
  const int axis = k % 3, first = k - axis;
  const Matrix3d R = hand_rotation(g);
  for (int node = 0; node < body_.node_count(); ++node) {
    const int i = body_.numbering[node];
    const Vector3d now = column.col(i).head<3>();
    published_.dx_dxi[g].block<3, 1>(3 * node, k) = now;
    if (i >= warp_.size()) continue;
    const Matrix3d W = warp_.matrix(i).cast<double>();
    auto then = at_snapshot_.dx_dxi[g].block<3, 3>(3 * node, first);
    const Vector3d change = W.transpose() * now - then * R.row(axis).transpose();
    then += change * R.row(axis);
  }
}

void TrackedSensitivity::follow_hands(NodalField& x) const noexcept {
  if (!published_.valid) return;
  for (int g = 0; g < body_.grasp_count(); ++g) {
    if (!boundary_.held()[g]) continue;
    const math::Vector6d motion = boundary_.pending_motion(g);
    if (motion.isZero(0)) continue;
    for (int node = 0; node < body_.node_count(); ++node) {
      x.col(body_.numbering[node]).head<3>() +=
          published_.dx_dxi[g].middleRows<3>(3 * node).lazyProduct(motion);
    }
  }
}

}  // namespace palpate::elasticity
