#pragma once

#include "core/elasticity/body.hpp"
#include "core/elasticity/body_system.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/factor/supernodal_factor.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

/// Point of the surface that presses on an obstacle. In O.
struct TouchingPoint {
  mesh::PointWeights point;
  int obstacle = 0;
  int hand = -1;  // grasp whose hand carries the obstacle; -1: none
  Eigen::Vector3d position = Eigen::Vector3d::Zero();           // m
  bool slips = false;                                           // at the limit of friction
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();            // unit vector out of the obstacle
  Eigen::Vector3d force = Eigen::Vector3d::Zero();              // N, on the object
  Eigen::Matrix3d normal_derivative = Eigen::Matrix3d::Zero();  // 1/m, by position
};

/// State at which derivatives are computed.
struct Snapshot {
  Eigen::Matrix3Xd positions;
  factor::Held held{false, false};
  std::array<math::Pose, 2> grasps{math::Pose::Identity(), math::Pose::Identity()};  // X_OG
  Eigen::Matrix3Xd loads;  // N, in addition to weight
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();
  std::array<mesh::PointWeights, kContactSlots> contacts;  // count 0: not configured
  std::vector<TouchingPoint> touching;
  /// X_OB of the obstacles, for their free directions.
  std::array<math::Pose, collision::kMostObstacles> obstacles{};
};

/// Derivatives of static equilibrium from one factorisation of its exact tangent K: with free nodes
/// f, a change p that prescribes displacements u_p and applies forces f_p yields
///   x' = u_p + K_ff^-1 (f_p - K u_p),   w' = G^T (K x' - f_p) + (dG^T) f,
/// G = [1, -[r]x] at the nodes of a patch (docs/theory.md, section 2). Points that touch an
/// obstacle add unknown changes of their contact forces, by a Schur complement: a sticking point
/// does not move; a slipping one moves across the normal, and its force keeps its direction
/// relative to the normal, which turns with the surface of the obstacle. An obstacle that a hand
/// carries moves with it; a touched obstacle may move in its free directions. At a change between
/// these states derivatives are one-sided. Allocates, does not throw.
class StaticResponse {
 public:
  /// `free`: directions in which obstacles may move.
  StaticResponse(const Body& body, const ElementSet& elements, const factor::BlockPattern& pattern,
                 std::vector<collision::FreeDirection> free = {});

  /// `K`: tangent at the snapshot; `factor`: its factorisation, positive definite with the held
  /// grasps.
  void compute(const Snapshot& at, const factor::BlockMatrix& K,
               const factor::SupernodalFactor& factor, Sensitivity& out);

 private:
  struct Columns;
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  void prescribe(const Snapshot& at, Columns& columns) const;
  void solve(const factor::BlockMatrix& K, const factor::SupernodalFactor& factor,
             factor::Held held, Columns& columns) const;
  void add_contact(const Snapshot& at, const factor::BlockMatrix& K,
                   const factor::SupernodalFactor& factor, Columns& columns,
                   Sensitivity& out) const;
  math::Vector6d reaction(const Snapshot& at, int g, const Eigen::Matrix3Xd& residual) const;
  Wrenches wrenches(const Snapshot& at, int g, const Eigen::Matrix3Xd& residual,
                    const Columns& columns) const;

  const Body& body_;
  const factor::BlockPattern& pattern_;
  std::vector<collision::FreeDirection> free_;
  Eigen::VectorXd nodal_mass_;
  /// The latter with the derivative with respect to Poisson's ratio.
  MeshForces forces_, poisson_forces_;
};

}  // namespace palpate::elasticity
