#pragma once

#include <vector>

#include "core/elasticity/body_system.hpp"
#include "core/estimation/consistency/wrench_states.hpp"
#include "core/estimation/contact_search.hpp"
#include "core/estimation/fused_state.hpp"

namespace palpate::estimation {

/// Derivatives of the hands' wrenches (N, N m, at G in O) with respect to what the model may lack.
/// By Betti's reciprocity the columns of the model's sensitivity give the response to any nodal
/// force: dw = -(dx/dxi)^T f. A clamp that moves by a rigid motion has the effect of hands and
/// gravity that move against it; stiffness that differs by element that of elastic forces of these
/// elements. Nothing allocates after construction.
class CauseResponses {
 public:
  static constexpr int kPlaces = 16;  // on the surface, where contacts and weights may act

  struct Hand {
    Eigen::Matrix<double, 6, 6> clamp_place;       // per m and rad about the clamp's centre, in O
    Eigen::Matrix<double, 6, 2> clamp_compliance;  // per m/N and rad/(N m)
    Eigen::Matrix<double, 6, 2> uneven_stiffness;  // per log of the stiffness of the halves
    std::array<Eigen::Matrix<double, 6, 3>, kPlaces> force;  // per N on the object, in O
  };

  /// The halves are separated across the direction from the clamp, or the other hand, to hand 0.
  CauseResponses(const elasticity::Body& body, const mesh::Surface& surface);

  /// The model's sensitivity must be valid.
  void update(const FusedState& state, const elasticity::DeformationModel& model) noexcept;

  const Hand& hand(int grasp) const noexcept { return hands_[grasp]; }
  int place_count() const noexcept { return static_cast<int>(places_.size()); }
  /// m, in O, at the last update.
  const Eigen::Vector3d& location(int place) const noexcept { return locations_[place]; }
  /// Unit vector into the object.
  const Eigen::Vector3d& inward(int place) const noexcept { return inward_[place]; }
  bool has_clamp() const noexcept { return has_clamp_; }
  /// Unit vector; zero without gravity.
  const Eigen::Vector3d& gravity_direction() const noexcept { return gravity_; }
  /// 1/(N/m) and 1/(N m/rad), compliance of the object itself as felt by hand 0, for scale.
  const Eigen::Vector2d& own_compliance() const noexcept { return own_compliance_; }

 private:
  /// The two halves of the object.
  struct Half {
    elasticity::MeshForces forces;
    Eigen::Matrix3Xd nodal;  // N, elastic forces of its elements at the last update
  };

  void choose_places(const elasticity::Body& body, const mesh::Surface& surface);
  void divide(const elasticity::Body& body);
  void update_clamp(const FusedState& state, const elasticity::DeformationModel& model) noexcept;
  /// Response of the hands to forces on all nodes, 3 x n, N.
  math::Vector6d response(int grasp, const Eigen::Matrix3Xd& forces, const FusedState& state,
                          const elasticity::DeformationModel& model) const noexcept;
  Eigen::Matrix<double, 6, 3> gravity_response(
      int grasp, const FusedState& state, const elasticity::DeformationModel& model) const noexcept;

  std::array<Hand, 2> hands_;
  std::vector<ContactSearch::Place> places_;
  std::vector<Eigen::Vector3d> locations_, inward_;
  std::vector<Half> halves_;
  Eigen::VectorXd nodal_mass_;  // kg
  bool has_clamp_ = false;
  Eigen::Vector3d clamp_O_ = Eigen::Vector3d::Zero();  // centre of the fixed nodes
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d own_compliance_ = Eigen::Vector2d::Zero();
};

}  // namespace palpate::estimation
