#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/joint_limits.hpp"

namespace palpate::robot {

/// A finger as a grasp sees it.
struct Finger {
  std::vector<int> joints;  // those that close it, by their place among the hand's joints
  double step = 0.05;       // rad in one control step, of each of them
};

/// Contact force of one finger, N.
struct ForceBand {
  double lower = 0.1;
  double upper = 1;
};

struct GraspOptions {
  /// Farthest that a target runs ahead of its joint, rad; with the servo's stiffness it bounds the
  /// force where a sensor reads nothing.
  double lead = 0.3;
  /// Smallest part of a step. A step halves wherever its finger turns round, so that a stiff object
  /// does not make it chatter about the band, and grows again without contact.
  double finest = 1.0 / 64;
};

/// The thesis' reactive grasp (Sanchez 2019, 4.5.1; its force band 0.1 to 1 N, joint step 0.05 rad,
/// thumb 0.03 rad, 100 Hz): each finger by itself closes by joint steps while its force is below
/// the band, opens by them while above, and stays within it. It knows joints and forces only.
class ReactiveGrasp {
 public:
  /// `limits` of all the hand's joints. Throws std::invalid_argument.
  ReactiveGrasp(std::vector<Finger> fingers, JointLimits limits, const GraspOptions& options = {});

  /// From these joint positions (rad), which are its targets until told what to do.
  void reset(const Eigen::VectorXd& q);

  void close(const ForceBand& band = {});
  void open();  // to the lower limits
  void stay();

  /// One control step: joint positions as measured (rad) and a contact force (N) a finger; a finger
  /// whose force is not finite stays. Returns the targets of all joints, rad.
  const Eigen::VectorXd& step(const Eigen::VectorXd& q, const Eigen::VectorXd& force);

  int finger_count() const { return static_cast<int>(fingers_.size()); }
  /// Fingers whose force was within the band in the last step; none but while closing.
  int in_band() const { return in_band_; }

 private:
  enum class Action { kStay, kClose, kOpen };
  struct Progress {
    double part = 1;    // of a step
    int direction = 0;  // of the last step, +1 closes
  };
  int direction(double force) const;
  double part(Progress& progress, int direction, bool touching) const;

  std::vector<Finger> fingers_;
  JointLimits limits_;
  GraspOptions options_;
  Action action_ = Action::kStay;
  ForceBand band_;
  std::vector<Progress> progress_;
  Eigen::VectorXd target_;
  int in_band_ = 0;
};

}  // namespace palpate::robot
