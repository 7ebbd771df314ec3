#pragma once

#include <array>
#include <cstdint>

#include "core/math/rigid.hpp"
#include "core/math/update_result.hpp"

namespace palpate::sensing {

/// Samples of one channel: all since the last tick, oldest first, and the latest one with its age.
/// Capacity is fixed; the receiver drops and counts excess samples.
template <class T, int kCapacity = 32>
struct Stream {
  Freshness freshness = Freshness::kNoData;
  double age = 1e9;  // s since the arrival of `latest`, monotonic clock
  T latest{};
  int fresh_count = 0;  // number of samples in this tick
  std::array<T, kCapacity> fresh{};
};

struct ForceTorque {
  double time = 0;   // s, clock of the sender
  math::Wrench F_S;  // wrench of the sensor on the hand, at the origin of S, in S
};

struct Inertial {
  double time = 0;
  Eigen::Vector3d acceleration_I = Eigen::Vector3d::Zero();      // specific force, m/s^2
  Eigen::Vector3d angular_velocity_I = Eigen::Vector3d::Zero();  // rad/s
};

struct RobotState {
  double time = 0;
  int joint_count = 0;
  Eigen::Matrix<double, 16, 1> q = Eigen::Matrix<double, 16, 1>::Zero();
  Eigen::Matrix<double, 16, 1> dq = Eigen::Matrix<double, 16, 1>::Zero();
  /// N m; all zero: not reported; not finite: reported, but not plausible.
  Eigen::Matrix<double, 16, 1> tau = Eigen::Matrix<double, 16, 1>::Zero();
  math::Pose X_WE = math::Pose::Identity();
  math::Twist V_W_E;
};

enum class Grasp { kNone, kHolding, kSlipping };

struct HandState {
  double time = 0;
  Grasp grasp = Grasp::kNone;
  int fingertip_count = 0;
  std::array<math::Pose, 5> X_ET{};
};

struct BioTac {
  double time = 0;
  Eigen::Matrix<double, 19, 1> electrodes = Eigen::Matrix<double, 19, 1>::Zero();  // counts
  double pac = 0;  // counts, first valid sample of the message
  double pdc = 0;
  double tac = 0;
  double tdc = 0;
};

/// Contact of a fingertip, in T.
struct FingertipContact {
  double time = 0;                                     // s, clock of the sender
  bool touches = false;                                // false: place and normal are zero
  Eigen::Vector3d place_T = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d normal_T = Eigen::Vector3d::Zero();  // unit vector, out of the fingertip
  Eigen::Vector3d force_T = Eigen::Vector3d::Zero();   // N, on the object
  double place_deviation = -1;                         // m, of each axis; negative: not known
  double force_deviation = -1;                         // N, likewise
  double area = -1;                                    // m^2; negative: not known
};

struct ManualForce {
  Eigen::Vector3d rest_point_O = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_O = Eigen::Vector3d::Zero();  // N
};

/// Observed points on the object's surface; correspondence to material points is unknown.
struct ShapeObservation {
  static constexpr int kMostPoints = 256;
  double time = 0;       // s, acquisition time by the clock of the sender
  double deviation = 0;  // m, standard deviation of each coordinate
  int count = 0;
  Eigen::Matrix<float, 3, kMostPoints> points_W = Eigen::Matrix<float, 3, kMostPoints>::Zero();
};

/// Pose and velocity of an obstacle B.
struct ObstacleState {
  double time = 0;              // s, clock of the sender
  std::array<char, 24> name{};  // zero-terminated
  math::Pose X_WB = math::Pose::Identity();
  math::Twist V_W_B;  // of the origin of B, in W
};

/// All inputs of the sensing stage in one tick, the observations for the estimator, and moving
/// obstacles.
struct Signals {
  double dt = 1e-3;  // s
  Stream<ForceTorque> force_torque;
  Stream<Inertial> inertial;
  Stream<RobotState> robot;
  Stream<HandState, 4> hand;
  std::array<Stream<BioTac, 4>, 5> biotac;
  std::array<Stream<FingertipContact, 4>, 5> fingertip;
  Stream<ManualForce, 4> manual;
  Stream<ShapeObservation, 1> observation;
  Stream<ObstacleState, 16> world;
};

}  // namespace palpate::sensing
