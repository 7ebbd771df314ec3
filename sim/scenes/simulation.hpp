#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/config/node.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/camera_publisher.hpp"
#include "sim/scenes/command_receiver.hpp"
#include "sim/scenes/fingertips.hpp"
#include "sim/scenes/hand_control.hpp"
#include "sim/scenes/pokes.hpp"
#include "sim/scenes/scene.hpp"
#include "sim/scenes/sensor_publisher.hpp"
#include "sim/scenes/truth_publisher.hpp"
#include "sim/sensors/sensor_suite.hpp"

namespace palpate::scenes {

/// What a message says of when and by whom it was sent. The default makes runs alike to the bit.
struct Origin {
  std::int64_t session = 1;
  std::int64_t start_utime = 0;  // us; utime of a message is this plus simulated time
};

/// Arm, object and sensors, stepped together, on two message buses. Time is counted in ticks of
/// 1 ms, and nothing depends on the real clock: the same scene and the same commands give the same
/// messages.
///
/// One tick: commands that have arrived (or the scene's own motion) -> arm and hand, with the
/// object's reaction on palm and fingertips -> object, with their new poses -> sensors -> messages.
/// The reaction is that of the tick before; the object is a hundredth of the hand's mass.
class Simulation {
 public:
  static constexpr std::int64_t kPeriodUs = 1000;
  static constexpr double kPeriod = 1e-6 * kPeriodUs;  // s

  /// Builds the scene and lets the object come to rest under gravity. Subscribes; the caller starts
  /// the buses afterwards. Throws config::Error (also where the robot's file cannot be used).
  Simulation(const config::Node& scene, bus::MessageBus& control, bus::MessageBus& housekeeping,
             const Origin& origin = {});

  /// utime of tick 0 from now on, us: the wall clock once the object has settled. Before step().
  void start_clock(std::int64_t start_utime) {
    origin_.start_utime = start_utime;
    sensor_publisher_.start_clock(start_utime);
    if (camera_) camera_->start_clock(start_utime);
  }

  /// For a run against the real clock: the camera's pictures may come late and are never waited
  /// for.
  void let_camera_lag() {
    if (camera_) camera_->let_lag();
  }

  /// One tick as a whole: obey(), advance(), publish().
  void step();

  /// Its parts, for a simulation that goes on while others still work on its last messages. obey():
  /// takes the commands that have arrived, for the next tick. advance(): arm, object and sensors.
  /// publish(): what sensors have to tell by now; publish_truth(): what scores need, on the
  /// housekeeping bus.
  void obey();
  void advance();
  void publish();
  void publish_truth();

  std::int64_t tick() const { return tick_; }
  double time() const { return kPeriod * tick_; }                                 // s
  std::int64_t utime() const { return origin_.start_utime + kPeriodUs * tick_; }  // us

  const Scene& scene() const { return scene_; }
  const robot::Robot& robot() const { return *robot_; }
  const object::HyperelasticPlant& plant() const { return *plant_; }
  const CommandReceiver& commands() const { return commands_; }
  const CameraPublisher* camera() const { return camera_.get(); }  // nullptr: the scene has none
  math::Pose grasp_in_object() const;                              // X_OG
  /// What the scene's motion asks for now; the first pose where there is none.
  math::Pose grasp_target() const;
  std::int64_t mesh_hash() const { return truth_.mesh_hash(); }

 private:
  void follow_motion();
  sensors::Truth sense() const;
  void follow_hand_plan();
  math::Twist grasp_twist() const;  // V_O_G

  Scene scene_;
  Origin origin_;
  std::unique_ptr<robot::Robot> robot_;
  FingertipCoupling fingertips_;
  math::Pose X_OG_first_;
  std::unique_ptr<object::HyperelasticPlant> plant_;
  Pokes pokes_;
  HandControl hand_;
  sensors::SensorSuite sensors_;
  CommandReceiver commands_;
  SensorPublisher sensor_publisher_;
  std::unique_ptr<CameraPublisher> camera_;
  TruthPublisher truth_;
  std::size_t next_action_ = 0;  // of the scene's plan for the hand
  std::int64_t tick_ = 0;
};

}  // namespace palpate::scenes
