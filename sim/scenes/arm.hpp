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

/// What a scene file says of one arm and its hand. W is the frame of this arm's base.
struct ArmScene {
  std::string urdf;
  robot::RobotOptions robot;
  math::Pose X_WO = math::Pose::Identity();    // where the object's frame stands
  Eigen::VectorXd initial_joints;              // rad
  std::map<std::string, double> initial_hand;  // rad, by joint; the others are at zero
  math::Pose X_EG = math::Pose::Identity();

  std::vector<Fingertip> fingertips;  // that touch the object; none: the fingers are air
  std::vector<HandAction> hand;       // beside what HAND_COMMAND says

  sensors::SensorTable sensors;
  std::optional<MotionPlan> motion;  // none: the arm obeys the daemon
  std::optional<bus::Key> key;       // of commands; none: nothing is checked
};

/// One arm with its hand and sensors, which holds the object by the plant's grasp of the same
/// number, or by fingertips. Arms know nothing of each other: they are coupled by the object alone,
/// and do not collide.
class Arm {
 public:
  /// Arm 0 or 1; all that is random in its sensors comes from `seed`. Subscribes. Throws
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
  /// with the object's reaction of the tick before on palm and fingertips.
  void step(std::int64_t tick, double time, double dt, const object::Plant& plant);

  /// Sends the plant's hand and fingertips to where the arm is now.
  void lead(object::Plant& plant) const;

  void sample(std::int64_t now_us, const object::Plant& plant);
  /// Sends what the sensors have to tell by now.
  void publish(std::int64_t now_us);

  const robot::Robot& robot() const { return *robot_; }
  const FingertipCoupling& fingertips() const { return fingertips_; }
  const CommandReceiver& commands() const { return commands_; }
  const ArmScene& scene() const { return scene_; }
  math::Pose grasp_in_object() const;  // X_OG
  /// What the scene's motion asks for; the first pose where there is none.
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
  std::size_t next_action_ = 0;  // of the scene's plan for the hand
};

}  // namespace palpate::scenes
