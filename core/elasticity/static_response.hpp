#pragma once

#include "core/elasticity/body.hpp"
#include "core/elasticity/mesh_forces.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/factor/supernodal_factor.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

/// A state of the object whose neighbourhood is asked for.
struct Snapshot {
  Eigen::Matrix3Xd positions;
  factor::Held held{false, false};
  std::array<Eigen::Vector3d, 2> origins{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  // of G
  Eigen::Matrix3Xd loads;  // N, beside weight
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();
  std::array<mesh::PointWeights, kContactSlots> contacts;  // count 0: not asked for
};

/// Derivatives of static equilibrium from one factorisation of its exact tangent K: with free nodes
/// f, a change p that puts nodes where u_p says and forces f_p on the object answers
///   x' = u_p + K_ff^-1 (f_p - K u_p),   w' = G^T (K x' - f_p) + (dG^T) f,
/// G = [1, -[r]x] at the nodes of a patch (control.md 6.2). Allocates, throws nothing.
class StaticResponse {
 public:
  StaticResponse(const Body& body, const ElementSet& elements, const factor::BlockPattern& pattern);

  /// `K`: tangent at the snapshot, `factor` its factorisation, positive with the held grasps.
  void compute(const Snapshot& at, const factor::BlockMatrix& K,
               const factor::SupernodalFactor& factor, Sensitivity& out);

 private:
  struct Columns;
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  void prescribe(const Snapshot& at, Columns& columns) const;
  void solve(const factor::BlockMatrix& K, const factor::SupernodalFactor& factor,
             factor::Held held, Columns& columns) const;
  Wrenches wrenches(const Snapshot& at, int g, const Eigen::Matrix3Xd& residual,
                    const Columns& columns) const;

  const Body& body_;
  const factor::BlockPattern& pattern_;
  Eigen::VectorXd nodal_mass_;
  MeshForces forces_, poisson_forces_;  // the second by Poisson's ratio
};

}  // namespace palpate::elasticity
