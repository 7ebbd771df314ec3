#pragma once

#include <cstdint>
#include <palpate/shape_observation_t.hpp>
#include <vector>

#include "core/math/random.hpp"
#include "rt/bus/stamped_publisher.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/scenes/scene.hpp"
#include "sim/sensors/channel.hpp"

namespace palpate::scenes {

/// A tracker of markers attached to the object: publishes SHAPE_OBSERVATION on the control bus with
/// point i at marker i; rate, delay, noise and losses as given by the scene; nothing during an
/// occlusion. Unlike the points of a depth camera, the markers are identified: this is the ideal
/// vision assumed by the published shape controllers, degraded as configured.
class MarkerPublisher {
 public:
  /// Precondition: the scene has markers. Throws std::invalid_argument if a marker is not on the
  /// object.
  MarkerPublisher(bus::MessageBus& control, const Scene& scene,
                  const object::HyperelasticPlant& plant, std::int64_t session,
                  std::int64_t start_utime);
  void start_clock(std::int64_t start_utime) { start_utime_ = start_utime; }

  /// Call once per tick, with increasing time: samples if due, publishes what has arrived.
  void step(std::int64_t now_us, const object::HyperelasticPlant& plant);

 private:
  struct Reading {
    std::int64_t time_us = 0;
    Eigen::Matrix3Xd points_W;
  };

  MarkerOptions options_;
  math::Pose X_WO_;
  std::vector<object::MaterialPoint> markers_;
  sensors::Channel<Reading> channel_;
  math::Random noise_;
  std::int64_t start_utime_;
  bus::StampedPublisher<shape_observation_t> publisher_;
};

}  // namespace palpate::scenes
