#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/config/node.hpp"
#include "sim/object/plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/command_receiver.hpp"
#include "sim/scenes/fingertips.hpp"
#include "sim/scenes/hand_control.hpp"
#include "sim/scenes/motion_plan.hpp"
#include "sim/scenes/sensor_publisher.hpp"
#include "sim/sensors/sensor_suite.hpp"

namespace palpate::scenes {

/// Settings of one arm and its hand in a scene file. W is the frame of this arm's base.
struct ArmScene {
  std::string urdf;
  robot::RobotOptions robot;
  math::Pose X_WO = math::Pose::Identity();    // pose of the object's frame
  Eigen::VectorXd initial_joints;              // rad
  std::map<std::string, double> initial_hand;  // rad, by joint; the others are at zero
  math::Pose X_EG = math::Pose::Identity();

  std::vector<Fingertip>
      fingertips;                // in contact with the object; empty: the fingers do not touch it
  std::vector<HandAction> hand;  // in addition to HAND_COMMAND

  sensors::SensorTable sensors;
  std::optional<MotionPlan> motion;  // empty: the arm follows the daemon's commands
  std::optional<bus::Key> key;  // for authentication of commands; empty: commands are not checked
};

/// One arm with its hand and sensors, which holds the object through the plant's grasp of the same
/// index, or by fingertips. Arms are coupled only through the object and do not collide.
class Arm {
 public:
  /// Arm 0 or 1; all randomness of its sensors derives from `seed`. Subscribes. Throws
  /// config::Error at the keys of `root`.
  Arm(const config::Node& root, const ArmScene& scene, int index, std::uint64_t seed,
      bus::MessageBus& control, std::int64_t session, std::int64_t start_utime);

  void start_clock(std::int64_t start_utime) {
    publisher_.start_clock(start_utime);
    commands_.begin(start_utime);
  }

  /// Takes the commands that have arrived, for the next step.
  void obey();

  /// One tick of `dt` s that begins at `time` s: follows the scene's motion or the last commands,
  /// with the object's reaction of the previous tick on palm and fingertips.
  void step(std::int64_t tick, double time, double dt, const object::Plant& plant);

  /// Passes the current pose of the arm to the plant's hand and fingertips.
  void lead(object::Plant& plant) const;

  void sample(std::int64_t now_us, const object::Plant& plant);
  /// Publishes the sensor readings that have arrived.
  void publish(std::int64_t now_us);

  const robot::Robot& robot() const { return *robot_; }
  const FingertipCoupling& fingertips() const { return fingertips_; }
  const CommandReceiver& commands() const { return commands_; }
  const ArmScene& scene() const { return scene_; }
  math::Pose grasp_in_object() const;  // X_OG
  /// The target of the scene's motion; the first pose if the scene has none.
  math::Pose grasp_target(double time) const;

 private:
  void follow_motion(double time);
  void follow_hand_plan(double time);
  sensors::Truth truth(const object::Plant& plant) const;
  math::Twist grasp_twist() const;  // V_O_G

  ArmScene scene_;
  int index_;
  std::unique_ptr<robot::Robot> robot_;
  FingertipCoupling fingertips_;
  math::Pose X_OG_first_;
  HandControl hand_;
  sensors::SensorSuite sensors_;
  CommandReceiver commands_;
  SensorPublisher publisher_;
  std::size_t next_action_ = 0;  // of the scene's schedule for the hand
};

}  // namespace palpate::scenes
