#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/config/node.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/scenes/arm.hpp"
#include "sim/scenes/camera_publisher.hpp"
#include "sim/scenes/marker_publisher.hpp"
#include "sim/scenes/pokes.hpp"
#include "sim/scenes/scene.hpp"
#include "sim/scenes/slips.hpp"
#include "sim/scenes/truth_publisher.hpp"

namespace palpate::scenes {

/// Time base and sender of the messages. The default makes runs bit-identical.
struct Origin {
  std::int64_t session = 1;
  std::int64_t start_utime = 0;  // us; utime of a message is this plus simulated time
};

/// One arm or two, object and sensors, stepped together, on two message buses. Time is counted in
/// ticks of 1 ms, and nothing depends on the real clock: the same scene and the same commands give
/// the same messages.
///
/// One tick: arrived commands (or the scene's own motion) -> arms and hands, with the object's
/// reaction on palm and fingertips -> object, with their new poses -> sensors -> messages. The
/// reaction is that of the previous tick; the object has a hundredth of the hand's mass.
class Simulation {
 public:
  static constexpr std::int64_t kPeriodUs = 1000;
  static constexpr double kPeriod = 1e-6 * kPeriodUs;  // s

  /// Builds the scene and lets the object settle under gravity. Subscribes; the caller starts the
  /// buses afterwards. `clouds` takes those of the scene's camera; without it none are sent. Throws
  /// config::Error (also if the robot's file cannot be used).
  Simulation(const config::Node& scene, bus::MessageBus& control, bus::MessageBus& housekeeping,
             const Origin& origin = {}, CloudSink clouds = nullptr);

  /// Sets utime of tick 0, us: the wall clock once the object has settled. Call before step().
  void start_clock(std::int64_t start_utime) {
    origin_.start_utime = start_utime;
    for (Arm& arm : arms_) arm.start_clock(start_utime);
    if (camera_) camera_->start_clock(start_utime);
    if (markers_) markers_->start_clock(start_utime);
  }

  /// For a real-time run: the camera's images may be late and are never waited for.
  void let_camera_lag() {
    if (camera_) camera_->let_lag();
  }

  /// One complete tick: obey(), advance(), publish().
  void step();

  /// Parts of a tick, for a simulation that continues while others still process its last messages.
  /// obey(): takes the commands that have arrived, for the next tick. advance(): arm, object and
  /// sensors. publish(): sensor readings that have arrived; publish_truth(): ground truth for
  /// evaluation, on the housekeeping bus.
  void obey();
  void advance();
  void publish();
  void publish_truth();

  std::int64_t tick() const { return tick_; }
  double time() const { return kPeriod * tick_; }                                 // s
  std::int64_t utime() const { return origin_.start_utime + kPeriodUs * tick_; }  // us

  const Scene& scene() const { return scene_; }
  int arm_count() const { return static_cast<int>(arms_.size()); }
  const Arm& arm(int index) const { return arms_[index]; }
  const object::Plant& object() const { return *plant_; }
  /// Throws std::logic_error if the scene's object is of another kind.
  const object::HyperelasticPlant& plant() const;
  const CameraPublisher* camera() const { return camera_.get(); }  // nullptr if the scene has none
  std::int64_t mesh_hash() const { return truth_.mesh_hash(); }

  // Of the first arm.
  const robot::Robot& robot() const { return arms_[0].robot(); }
  const CommandReceiver& commands() const { return arms_[0].commands(); }
  math::Pose grasp_in_object() const { return arms_[0].grasp_in_object(); }  // X_OG
  /// Current target of the scene's motion; the first pose if the scene has none.
  math::Pose grasp_target() const { return arms_[0].grasp_target(time()); }

 private:
  std::vector<math::Pose> grasps_in_object() const;
  void cut();

  Scene scene_;
  Origin origin_;
  std::vector<Arm> arms_;
  std::unique_ptr<object::Plant> plant_;
  Pokes pokes_;
  Slips slips_;
  std::unique_ptr<CameraPublisher> camera_;
  std::unique_ptr<MarkerPublisher> markers_;
  TruthPublisher truth_;
  std::size_t cuts_done_ = 0;
  std::int64_t tick_ = 0;
};

}  // namespace palpate::scenes
