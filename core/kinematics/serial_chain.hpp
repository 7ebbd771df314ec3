#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::kinematics {

/// Actuated joint of an arm, in order from the base. Fixed joints are part of the origin of the
/// next actuated joint.
struct Joint {
  std::string name;
  bool revolute = true;  // false: prismatic
  /// Pose of the joint frame in the previous one, at q = 0.
  math::Pose X_PJ = math::Pose::Identity();
  Eigen::Vector3d axis_J = Eigen::Vector3d::UnitZ();  // unit length
  double lower = 0, upper = 0;                        // rad or m
  double speed = 0;                                   // rad/s or m/s, > 0
};

/// Serial arm from its base W to its flange E.
class SerialChain {
 public:
  static constexpr int kMostJoints = 16;
  using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostJoints, 1>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostJoints>;

  /// `X_JE`: pose of the flange in the last joint's frame. Throws std::invalid_argument, naming the
  /// joint, if there are no or too many joints, limits are empty or not finite, or an axis is not
  /// of unit length.
  SerialChain(std::vector<Joint> joints, const math::Pose& X_JE);

  int joint_count() const noexcept { return static_cast<int>(joints_.size()); }
  const Joint& joint(int index) const noexcept { return joints_[index]; }
  const math::Pose& X_JE() const noexcept { return X_JE_; }

  /// Frames of the joints in W, each moved by its own position. Joint i moves about, or along, the
  /// axis `axis_J` of its frame.
  using Frames = std::array<math::Pose, kMostJoints>;
  /// For joint_count() positions `q`. Does not allocate.
  void locate(const Eigen::Ref<const Eigen::VectorXd>& q, Frames& X_WJ) const noexcept;

  struct State {
    math::Pose X_WE = math::Pose::Identity();
    Jacobian J_W_E;  // twist of the origin of E in W per joint velocity, linear part first
  };
  /// Evaluates pose and Jacobian for joint_count() positions `q`. Does not allocate.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& q, State& state) const noexcept;

 private:
  std::vector<Joint> joints_;
  math::Pose X_JE_;
};

}  // namespace palpate::kinematics
