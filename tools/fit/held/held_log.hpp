#pragma once

#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::fit {

/// Lower bounds of a sensor's standard deviation, regardless of its scatter: N and N m.
inline constexpr double kFinestForce = 1e-3, kFinestTorque = 1e-4;
/// Components of a wrench, in the order of its six numbers.
inline constexpr const char* kWrench[6] = {"fx", "fy", "fz", "tx", "ty", "tz"};

/// Selection of the moments of a recording that count as equilibria. The log is divided into blocks
/// of 0.1 s; a block is calm if the mean pose of the hand moves by less than the two speeds
/// relative to both of its neighbours. A sample is the mean over `window` of calm blocks that
/// follow `settle` of them. Without `settle` and with higher speeds, slow motion counts as a
/// sequence of equilibria.
struct CalmRule {
  double linear_speed = 2e-3;   // m/s
  double angular_speed = 1e-2;  // rad/s
  double settle = 0.5;          // s, for vibrations to decay
  double window = 0.5;          // s
  double every = 1.0;           // s between the starts of samples, at least
};

/// A mean over kBlock s of a hand's log.
struct HeldBlock {
  math::Pose X_WE = math::Pose::Identity();
  math::Vector6d wrench = math::Vector6d::Zero();
  bool whole = false;  // pose and wrench have been received
  bool calm = false;
};

inline constexpr double kBlock = 0.1;  // s

/// Mean of poses that differ only slightly.
class PoseMean {
 public:
  void add(const math::Pose& X);
  int count() const { return count_; }
  math::Pose get() const;

 private:
  math::Pose first_ = math::Pose::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero(), turn_ = Eigen::Vector3d::Zero();
  int count_ = 0;
};

/// Data of a log for the fit of a held object.
struct HeldLog {
  std::vector<robot_state_t> robot;
  std::vector<ft_wrench_t> wrenches;
  std::vector<shape_observation_t> seen;
  std::int64_t begin = 0;         // us, of the first block
  std::vector<HeldBlock> blocks;  // marked by the rule
};

/// Reads ROBOT_STATE, FT_WRENCH and SHAPE_OBSERVATION. `time`: "sent" or "received", the clock to
/// use. Throws std::runtime_error naming file and remedy: a missing channel, numbers that are not
/// finite.
HeldLog read_held_log(const std::string& log, const CalmRule& rule, const std::string& time);

/// Angle from one pose to another, rad.
double turn_between(const math::Pose& a, const math::Pose& b);

/// The hand at rest, or nearly so.
struct HeldSample {
  double time = 0;  // s since the start of the recording
  math::Pose X_WE = math::Pose::Identity();
  math::Wrench F_S;             // as reported by the sensor
  Eigen::Matrix3Xd points_W;    // m, observed on the surface; none without an observation
  std::vector<math::Pose> way;  // X_WE on the path from the previous sample
};

struct HeldRecording {
  std::vector<HeldSample> samples;
  math::Vector6d deviation;    // standard, of F_S of one sample: from the scatter of its blocks
  double point_deviation = 0;  // m, of each coordinate
};

/// The samples of a log by the rule. `average_points`: all messages of a window contain the same
/// points in the same order (markers); otherwise the message in its middle is used. Throws as
/// read_held_log() does, and if there is no sample at all.
HeldRecording read_held_recording(const std::string& log, const CalmRule& rule,
                                  const std::string& time, bool average_points);

}  // namespace palpate::fit
