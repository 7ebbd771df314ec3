#pragma once

#include "core/elasticity/body.hpp"
#include "core/elasticity/body_system.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/factor/supernodal_factor.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

/// State at which derivatives are computed.
struct Snapshot {
  Eigen::Matrix3Xd positions;
  factor::Held held{false, false};
  std::array<math::Pose, 2> grasps{math::Pose::Identity(), math::Pose::Identity()};  // X_OG
  Eigen::Matrix3Xd loads;  // N, in addition to weight
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();
  std::array<mesh::PointWeights, kContactSlots> contacts;  // count 0: not configured
};

/// Derivatives of static equilibrium from one factorisation of its exact tangent K: with free nodes
/// f, a change p that prescribes displacements u_p and applies forces f_p yields
///   x' = u_p + K_ff^-1 (f_p - K u_p),   w' = G^T (K x' - f_p) + (dG^T) f,
/// G = [1, -[r]x] at the nodes of a patch (docs/theory.md, section 2). Allocates, does not throw.
class StaticResponse {
 public:
  StaticResponse(const Body& body, const ElementSet& elements, const factor::BlockPattern& pattern);

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
  math::Vector6d reaction(const Snapshot& at, int g, const Eigen::Matrix3Xd& residual) const;
  Wrenches wrenches(const Snapshot& at, int g, const Eigen::Matrix3Xd& residual,
                    const Columns& columns) const;

  const Body& body_;
  const factor::BlockPattern& pattern_;
  Eigen::VectorXd nodal_mass_;
  /// The latter with the derivative with respect to Poisson's ratio.
  MeshForces forces_, poisson_forces_;
};

}  // namespace palpate::elasticity
