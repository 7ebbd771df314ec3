#pragma once

#include <cstdint>
#include <functional>
#include <palpate/shape_observation_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/config/node.hpp"
#include "sim/camera/background_camera.hpp"
#include "sim/camera/depth_camera.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/scene.hpp"
#include "sim/sensors/channel.hpp"

namespace palpate::scenes {

/// A scene's key "camera": its pose (`pose` X_WC, or `eye` and `target` in W; default target is the
/// centre of the object at rest), the clouds (`cloud`: `channel`, `stride`), the `colour` of the
/// object, and with `truth_segmentation` how the simulator segments it (`segmentation`: colour or
/// truth; `box` in O; `tolerance`; `margin`) and the spacing of its points (`voxel`). Requires the
/// scene's object and sensors to be read already. Throws config::Error.
camera::ShapeCameraOptions read_camera(const config::Node& node, const Scene& scene);
/// `cloud.channel` of the same key.
std::string read_cloud_channel(const config::Node& node);

/// `occlusions` of the same key: the camera observes and sends nothing from `at` on for `duration`
/// s.
std::vector<Occlusion> read_occlusions(const config::Node& node);
bool is_occluded(const std::vector<Occlusion>& occlusions, std::int64_t now_us);

/// Points in W, at most as many as the message holds, and their standard deviation, m.
shape_observation_t make_observation(const Eigen::Matrix3Xd& points_W, double deviation);

/// Bodies in view of a scene's camera: arms and hands as the primitive shapes of their URDF file,
/// the object, and a block of the test rig behind the clamped face.
class CameraScenery {
 public:
  CameraScenery(const Scene& scene, const std::vector<Arm>& arms);

  /// All bodies at their current poses, in W of the first arm. A copy, which another thread may
  /// render.
  std::vector<camera::Body> now(const std::vector<Arm>& arms, const object::Plant& plant) const;

 private:
  struct Visual {
    std::size_t arm;
    std::string link;
    camera::Body body;  // posed in the link
  };
  std::vector<Visual> visuals_;
  std::vector<camera::Body> still_;
  math::Pose X_WO_;
  draw::Colour object_colour_;
};

/// Takes an encoded drake/lcmt_point_cloud and the time (us) at which it is sent.
using CloudSink = std::function<void(const std::string& channel,
                                     const std::vector<std::uint8_t>& message, std::int64_t utime)>;

/// A scene's camera: sends clouds of all that it shows, in C, and with `truth_segmentation`
/// publishes SHAPE_OBSERVATION on the control bus, at the camera's rate, with delay and losses of
/// the sensor table; nothing during an occlusion. Images are rendered in a separate thread. By
/// default the simulation waits for an image when it is due to arrive, so that the same scene gives
/// bit-identical messages; a real-time simulation lets the camera lag.
class CameraPublisher {
 public:
  /// Precondition: the scene has a camera. Without a sink no clouds are sent. Throws
  /// std::runtime_error if rendering is unavailable.
  CameraPublisher(bus::MessageBus& control, CloudSink clouds, const Scene& scene,
                  const std::vector<Arm>& arms, std::int64_t session, std::int64_t start_utime);
  void start_clock(std::int64_t start_utime) { start_utime_ = start_utime; }

  /// Disables waiting: an image that is not ready is sent late, and one due while another is
  /// rendered is omitted.
  void let_lag() { may_lag_ = true; }

  /// Call once per tick, with increasing time: takes an image if one is due, publishes what has
  /// arrived.
  void step(std::int64_t now_us, const std::vector<Arm>& arms, const object::Plant& plant);

  std::int64_t left_out() const { return left_out_; }

 private:
  struct Reading {
    std::int64_t time_us = 0;  // of the image, as the messages state it
    camera::ShapeReading shape;
  };
  void collect(bool wait);
  void publish(const Reading& reading, std::int64_t now_us);

  sensors::Channel<Reading> channel_;
  std::int64_t delay_us_;
  std::vector<Occlusion> occlusions_;
  math::Random noise_;
  CameraScenery scenery_;
  camera::BackgroundCamera camera_;
  std::int64_t drawn_us_ = 0;  // sampling time of the image being rendered
  std::int64_t pictures_ = 0;
  std::int64_t left_out_ = 0;
  bool may_lag_ = false;
  std::int64_t start_utime_;
  bool has_shape_, has_clouds_;
  std::string cloud_channel_;
  CloudSink clouds_;
  bus::StampedPublisher<shape_observation_t> publisher_;
};

}  // namespace palpate::scenes
