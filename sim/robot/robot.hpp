#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/robot/hand_drive.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/velocity_follower.hpp"

namespace palpate::robot {

/// Links of the URDF file that serve as frames. All are fixed to the arm's last moving link;
/// everything beyond `sensor` is the load measured by the force-torque sensor.
struct FrameNames {
  std::string flange = "flange";  // E
  std::string sensor = "sensor";  // S
  std::string imu = "imu";        // I
};

/// A rigid body on the measured side of the force-torque sensor, in addition to the URDF's links.
struct Load {
  double mass = 0;                                           // kg
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  // m, in the link `sensor`
  /// xx, xy, xz, yy, yz, zz about the centre of mass, axes of the link `sensor`, kg m^2.
  math::Vector6d inertia = math::Vector6d::Zero();
};

struct RobotOptions {
  FrameNames frames;
  double hand_mass_factor = 1;  // on mass and inertia of all links beyond S
  Load load;
  FollowerOptions follower;
  HandOptions hand;
  double bandwidth = 15;                   // Hz, of the computed-torque controller
  Eigen::Vector3d gravity_W{0, 0, -9.81};  // m/s^2
};

struct ImuReading {
  Eigen::Vector3d acceleration;      // m/s^2 in I, specific force: a body at rest reads -gravity
  Eigen::Vector3d angular_velocity;  // rad/s in I
};

/// An arm with a hand in a DART world, driven by commanded velocities through inverse dynamics. W
/// is the frame of the URDF's root link, which is fixed. The arm's joints are those between the
/// root and the flange. The hand's joints are those beyond the flange that have speed and effort
/// limits; they hold their position until commanded. All other joints hold their position
/// throughout. Every quantity refers to the end of the last step.
class Robot {
 public:
  /// Throws std::invalid_argument if the model cannot be used.
  Robot(const RobotModel& model, const RobotOptions& options);
  Robot(Robot&& other) noexcept;
  ~Robot();

  int joint_count() const;
  /// Warnings about the model's masses and inertias.
  const std::vector<std::string>& remarks() const;
  /// The settings that DART itself reports for it, in one line.
  std::string effective_options() const;
  const JointLimits& limits() const;

  /// Resets to rest at `q` (rad). Throws if a joint is outside its limits.
  void set_joints(const Eigen::VectorXd& q);

  /// A command holds until the next one, at most for the follower's time-out.
  void command_twist(const math::Twist& V_WE);
  void command_joints(const Eigen::VectorXd& joint_velocity);  // rad/s
  void stop();

  /// Wrench of the object on the hand about the point p_W, in W; acts in every step until replaced.
  void set_hand_load(const math::Wrench& F_W, const Eigen::Vector3d& p_W);

  /// The same on one link, in addition to the wrench on the hand; a load on a finger moves its
  /// joints. Throws std::invalid_argument if there is no such link.
  void set_link_load(const std::string& link, const math::Wrench& F_W, const Eigen::Vector3d& p_W);
  /// The wrench set last, about its own reference point; zero at first.
  math::Wrench link_load(const std::string& link) const;

  void step(double dt);

  Eigen::VectorXd joint_positions() const;   // rad
  Eigen::VectorXd joint_velocities() const;  // rad/s
  Eigen::VectorXd joint_torques() const;     // N m, of the last step
  /// Whether a torque limit clipped the last step's request, and the number of steps in which one
  /// did.
  bool torque_limited() const;
  std::int64_t torque_limited_steps() const;
  math::Pose flange_pose() const;    // X_WE
  math::Twist flange_twist() const;  // V_W_E of the origin of E, in W
  /// 6 x n: flange twist by joint velocities, linear first.
  Eigen::Matrix<double, 6, Eigen::Dynamic> flange_jacobian() const;

  /// Wrench of the sensor on its load at the origin of S, in S: Newton-Euler equations summed over
  /// every body beyond S, from DART's accelerations, minus the object's load.
  math::Wrench sensor_wrench() const;
  ImuReading imu() const;

  bool has_link(const std::string& name) const;
  /// Throw std::invalid_argument if there is no such link.
  math::Pose link_pose(const std::string& name) const;
  math::Twist link_twist(const std::string& name) const;  // of the link's origin, in W

  /// The hand's joints, in the order of its targets.
  const std::vector<std::string>& hand_joint_names() const { return hand_joint_names_; }
  /// Indices of the joints between the flange and this link, starting at the flange. Throws as
  /// link_pose.
  std::vector<int> hand_joints_to(const std::string& link) const;
  const JointLimits& hand_limits() const;
  /// Resets to rest at `q` (rad). Throws if a joint is outside its limits.
  void set_hand(const Eigen::VectorXd& q);
  /// Targets of all the hand's joints, rad, clamped to their limits; they hold until replaced.
  /// Throws std::invalid_argument if their number is wrong or a value is not finite.
  void command_hand(const Eigen::VectorXd& targets);
  Eigen::VectorXd hand_positions() const;   // rad
  Eigen::VectorXd hand_velocities() const;  // rad/s
  Eigen::VectorXd hand_torques() const;     // N m, of the last step; 0 before the first command
  const std::vector<VisualShape>& visuals() const { return visuals_; }

 private:
  struct Dynamics;
  std::unique_ptr<Dynamics> dynamics_;
  std::vector<VisualShape> visuals_;
  std::vector<std::string> hand_joint_names_;
};

}  // namespace palpate::robot
