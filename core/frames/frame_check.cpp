#include "core/frames/frame_check.hpp"

#include <cmath>

namespace palpate::frames {
namespace {

constexpr double kLatest = 0.1;                    // s, age of what is compared
constexpr double kSlow = 0.005, kSlowTurn = 0.02;  // m/s, rad/s: the hand rests
constexpr double kPart = 0.05;                     // of gravity, that acceleration may add
constexpr double kCosine = 0.8660254037844386;     // of 30 degrees

bool rests(const sensing::Signals& signals) noexcept {
  const math::Twist& V = signals.robot.latest.V_W_E;
  return V.linear.norm() < kSlow && V.angular.norm() < kSlowTurn &&
         signals.inertial.latest.angular_velocity_I.norm() < kSlowTurn;
}

}  // namespace

const char* frame_contradiction(const ArmMeasurements& arm) noexcept {
  const sensing::Stream<sensing::Inertial>& inertial = arm.signals.inertial;
  const double gravity = arm.frames.gravity_W.norm();
  if (!arm.known || inertial.freshness == Freshness::kNoData || inertial.age > kLatest ||
      arm.signals.robot.age > kLatest || gravity == 0 || !rests(arm.signals))
    return "";
  const Eigen::Vector3d& measured_I = inertial.latest.acceleration_I;
  if (std::abs(measured_I.norm() - gravity) > kPart * gravity) return "";
  const Eigen::Matrix3d R_WI = arm.signals.robot.latest.X_WE.linear() * arm.frames.X_EI.linear();
  const double cosine =
      -(R_WI * measured_I).dot(arm.frames.gravity_W) / (measured_I.norm() * gravity);
  if (cosine >= kCosine) return "";
  return "IMU at rest measures gravity in another direction than frames.imu_in_flange and the "
         "robot's pose give";
}

}  // namespace palpate::frames
