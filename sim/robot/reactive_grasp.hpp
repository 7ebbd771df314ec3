#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/joint_limits.hpp"

namespace palpate::robot {

/// A finger as the grasp controller uses it.
struct Finger {
  std::vector<int> joints;  // closing joints, as indices into the hand's joints
  double step = 0.05;       // rad per control step, for each closing joint
};

/// Contact force of one finger, N.
struct ForceBand {
  double lower = 0.1;
  double upper = 1;
};

struct GraspOptions {
  /// Largest distance by which a target leads its joint, rad; with the servo stiffness it bounds
  /// the force if a sensor reads zero.
  double lead = 0.3;
  /// Smallest fraction of a step. The step is halved at each reversal of the finger, so that a
  /// stiff object does not cause chatter about the force band, and grows again without contact.
  double finest = 1.0 / 64;
};

/// The thesis' reactive grasp (Sanchez 2019, 4.5.1; its force band 0.1 to 1 N, joint step 0.05 rad,
/// thumb 0.03 rad, 100 Hz): each finger independently closes by joint steps while its force is
/// below the band, opens by them while above, and stays within it. It uses only joint positions and
/// forces.
class ReactiveGrasp {
 public:
  /// `limits` of all joints of the hand. Throws std::invalid_argument.
  ReactiveGrasp(std::vector<Finger> fingers, JointLimits limits, const GraspOptions& options = {});

  /// Starts from these joint positions (rad), which are the targets until the first command.
  void reset(const Eigen::VectorXd& q);

  void close(const ForceBand& band = {});
  void open();  // opens to the lower limits
  void stay();

  /// One control step: measured joint positions (rad) and one contact force (N) per finger; a
  /// finger whose force is not finite does not move. Returns the targets of all joints, rad.
  const Eigen::VectorXd& step(const Eigen::VectorXd& q, const Eigen::VectorXd& force);

  int finger_count() const { return static_cast<int>(fingers_.size()); }
  /// Number of fingers whose force was within the band in the last step; counted only while
  /// closing.
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
