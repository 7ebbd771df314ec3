#pragma once

#include <vector>

#include "core/kinematics/serial_chain.hpp"

namespace palpate::kinematics {

/// Inertia of a body about the origin of a frame A, in the axes of A.
struct BodyInertia {
  double mass = 0;                                         // kg
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  // kg m, mass times centre of mass
  Eigen::Matrix3d rotational = Eigen::Matrix3d::Zero();    // kg m^2

  /// `of_B`: about the origin of B, in B. Returns the same body's inertia in A.
  static BodyInertia moved(const math::Pose& X_AB, const BodyInertia& of_B) noexcept;
  BodyInertia& operator+=(const BodyInertia& other) noexcept;
};

/// Rigid-body dynamics of a serial arm with a fixed base, as a momentum observer needs them:
///   d/dt (M dq) = tau + C^T dq - g + tau_ext.
/// One recursion over the spatial momenta of the links (Featherstone 2008, chapter 2): joint i has
/// the generalised momentum S_i . h_i, where h_i is the momentum of everything beyond the joint,
/// about the origin of W, and its rate contains (d S_i / dt) . h_i, which is entry i of C^T dq.
class ChainDynamics {
 public:
  using Joints = SerialChain::Joints;

  /// `links`: what each joint of the chain moves rigidly, in the frame J of the joint (Joint);
  /// `gravity_W`: m/s^2. Throws std::invalid_argument if the number of links differs, a mass is
  /// negative or a number is not finite.
  ChainDynamics(SerialChain chain, std::vector<BodyInertia> links,
                const Eigen::Vector3d& gravity_W);

  struct State {
    Joints momentum;  // M dq; column i of M for dq = e_i
    Joints coriolis;  // C^T dq, with the C of Christoffel symbols: dM/dt = C + C^T
    Joints gravity;   // g, torque that holds the arm against its weight
  };
  /// For joint_count() positions and velocities; N m or N, and N m s or N s. Does not allocate.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                const Eigen::Ref<const Eigen::VectorXd>& dq, State& state) const noexcept;

  const SerialChain& chain() const noexcept { return chain_; }

 private:
  SerialChain chain_;
  std::vector<BodyInertia> links_;
  Eigen::Vector3d gravity_W_;
};

}  // namespace palpate::kinematics
