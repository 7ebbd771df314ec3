#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/collision/free_directions.hpp"
#include "core/elasticity/element_stress.hpp"
#include "core/math/rigid.hpp"

namespace palpate::elasticity {

/// Rotation of each node since a snapshot, as rotation matrices W. With a factor L computed at the
/// snapshot, W L^-T L^-1 W^T solves approximately with the present tangent as long as elements have
/// rotated but not deformed much (stiffness warping; Hecht et al. 2012 for factors).
class NodeWarp {
 public:
  explicit NodeWarp(int nodes);

  /// `now`: present rotations, `snapshot`: those at the snapshot; unit quaternions w x y z by
  /// column; columns beyond the size of the warp are ignored.
  void update(const Eigen::Matrix4Xf& now, const Eigen::Matrix4Xf& snapshot) noexcept;

  int size() const noexcept { return nodes_; }
  Eigen::Matrix3f matrix(int node) const noexcept {
    return Eigen::Map<const Eigen::Matrix3f>(matrices_.data() + 9 * node);
  }

  /// v <- W v and v <- W^T v, three floats per node.
  void turn(Eigen::VectorXf& v) const noexcept;
  void turn_back(Eigen::VectorXf& v) const noexcept;

  /// Largest rotation angle of a node, rad.
  double largest() const noexcept { return largest_; }

 private:
  int nodes_;
  Eigen::VectorXf matrices_;  // 9 per node
  double largest_ = 0;
};

/// Maximum number of points for which the response to a contact force is computed.
inline constexpr int kContactSlots = 4;

/// Derivatives of the static equilibrium. xi = (displacement of the origin of G, m; rotation about
/// it, rad), both in O; w = wrench of the hand on the object at the origin of G, in O. Computed
/// from the exact tangent at a snapshot some ticks ago and, except for the stress, rotated with the
/// object since. The wrenches' derivative by log E follows the change of the wrenches as well,
/// which is proportional to E. Shapes are stacked node by node (x, y, z), with zero rows for fixed
/// nodes.
struct Sensitivity {
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  bool valid = false;
  double age = 0;  // s since the snapshot

  /// Per motion of each held grasp; zero if not held.
  std::array<Motion, 2> dx_dxi;
  /// [a][b]: wrench of hand a per motion of grasp b
  std::array<std::array<math::Matrix6d, 2>, 2> dw_dxi;

  /// Derivatives with respect to material parameters: logarithm of Young's modulus (the same factor
  /// for all elements), Poisson's ratio (the same increment for all), logarithm of density.
  enum Parameter { kLogYoung, kPoisson, kLogDensity };
  Eigen::Matrix<double, Eigen::Dynamic, 3> dx_dparameter;
  std::array<Eigen::Matrix<double, 6, 3>, 2> dw_dparameter;
  /// Wrench of each hand at the snapshot.
  std::array<math::Vector6d, 2> reaction{math::Vector6d::Zero(), math::Vector6d::Zero()};

  /// Per force, N, in the axes of O, at each configured contact point; zero for others.
  std::array<Eigen::Matrix<double, Eigen::Dynamic, 3>, kContactSlots> dx_dforce;
  std::array<std::array<Eigen::Matrix<double, 6, 3>, kContactSlots>, 2> dw_dforce;

  /// Per motion of each held grasp: the sum, N, of the normal forces of the points that press on
  /// each obstacle; zero for obstacles that were not touched.
  std::array<std::array<Eigen::Matrix<double, 1, 6>, 2>, collision::kMostObstacles> dcontact_dxi;

  /// Per motion of obstacles in their free directions (m, rad; collision::free_directions); zero
  /// for obstacles that were not touched.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic> dx_dobstacle;
  using ObstacleWrenches =
      Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, collision::kMostFreeDirections>;
  std::array<ObstacleWrenches, 2> dw_dobstacle;
  /// The sum, N, of the normal forces on each obstacle, by the same motions.
  std::array<Eigen::Matrix<double, 1, Eigen::Dynamic, 1, 1, collision::kMostFreeDirections>,
             collision::kMostObstacles>
      dcontact_dobstacle;

  /// Smallest pivot of the static tangent divided by its diagonal entry: decreases to zero as the
  /// object approaches buckling (recommended warning level: one twentieth of its value at rest).
  double smallest_pivot = 0;

  /// Stress at the snapshot, in the axes at that time, not rotated since. Its von Mises stresses
  /// are invariant under subsequent rigid motion. Empty if the model provides none.
  ElementStress stress;

  /// Sets zeros for a mesh of `nodes` nodes, except for the stress. Allocates.
  void resize(int nodes, int free_directions = 0);
};

/// Rotations since a snapshot.
struct Turned {
  const NodeWarp& nodes;              // in the solver's numbering
  const std::vector<int>& numbering;  // of mesh nodes; numbers beyond the warp's size: fixed
  std::array<Eigen::Matrix3d, 2> grasps{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  std::array<Eigen::Matrix3d, kContactSlots> contacts{};
  std::array<bool, 2> is_held{false, false};  // grasps that are not held have no columns
  std::array<bool, kContactSlots> is_watched{};
};

/// `now` = sensitivity of a snapshot rotated with its nodes, exact for an object that has moved as
/// a rigid body: rows of the mesh nodes `begin` to `end`, so that the work can be spread over
/// ticks, and the wrenches. Copies validity; age and stress are unchanged. Sizes must match.
void turn(const Sensitivity& snapshot, const Turned& turned, int begin, int end,
          Sensitivity& now) noexcept;

}  // namespace palpate::elasticity
