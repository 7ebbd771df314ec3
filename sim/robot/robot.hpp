#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/velocity_follower.hpp"

namespace palpate::robot {

/// Links of the URDF file that serve as frames. All are fixed to the arm's last moving link, and
/// everything beyond `sensor` is the load that the force-torque sensor feels.
struct FrameNames {
  std::string flange = "flange";  // E
  std::string sensor = "sensor";  // S
  std::string imu = "imu";        // I
};

struct RobotOptions {
  FrameNames frames;
  FollowerOptions follower;
  double bandwidth = 15;                   // Hz, of the computed-torque controller
  Eigen::Vector3d gravity_W{0, 0, -9.81};  // m/s^2
};

struct ImuReading {
  Eigen::Vector3d acceleration;      // m/s^2 in I, specific force: a body at rest reads -gravity
  Eigen::Vector3d angular_velocity;  // rad/s in I
};

/// An arm with a hand in a DART world, moved by commanded velocities through inverse dynamics. W is
/// the frame of the URDF's root link, which is fixed. Driven joints are those between the root and
/// the flange; others keep their place. Every quantity is that of the end of the last step.
class Robot {
 public:
  /// Throws std::invalid_argument where the model cannot be used.
  Robot(const RobotModel& model, const RobotOptions& options);
  ~Robot();

  int joint_count() const;
  const JointLimits& limits() const;

  /// At rest in `q` (rad). Throws where a joint is beyond its limits.
  void set_joints(const Eigen::VectorXd& q);

  /// A command holds until the next one, at most for the follower's time-out.
  void command_twist(const math::Twist& V_WE);
  void command_joints(const Eigen::VectorXd& joint_velocity);  // rad/s
  void stop();

  /// Wrench of the object on the hand about the point p_W, in W; acts in every step until replaced.
  void set_hand_load(const math::Wrench& F_W, const Eigen::Vector3d& p_W);

  void step(double dt);

  Eigen::VectorXd joint_positions() const;   // rad
  Eigen::VectorXd joint_velocities() const;  // rad/s
  Eigen::VectorXd joint_torques() const;     // N m, of the last step
  math::Pose flange_pose() const;            // X_WE
  math::Twist flange_twist() const;          // V_W_E of the origin of E, in W
  /// 6 x n: flange twist by joint velocities, linear first.
  Eigen::Matrix<double, 6, Eigen::Dynamic> flange_jacobian() const;

  /// What the sensor exerts on its load at the origin of S, in S: Newton and Euler's laws summed
  /// over every body beyond S, from DART's accelerations, less the object's load.
  math::Wrench sensor_wrench() const;
  ImuReading imu() const;

  bool has_link(const std::string& name) const;
  /// Throws std::invalid_argument where there is no such link.
  math::Pose link_pose(const std::string& name) const;
  const std::vector<VisualShape>& visuals() const { return visuals_; }

 private:
  struct Dynamics;
  std::unique_ptr<Dynamics> dynamics_;
  std::vector<VisualShape> visuals_;
};

}  // namespace palpate::robot
