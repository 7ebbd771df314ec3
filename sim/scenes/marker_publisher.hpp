#pragma once

#include <cstdint>
#include <palpate/shape_observation_t.hpp>
#include <vector>

#include "core/math/random.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/scenes/scene.hpp"
#include "sim/sensors/channel.hpp"

namespace palpate::scenes {

/// A tracker of markers stuck to the object: SHAPE_OBSERVATION on the control bus with point i at
/// marker i, at a rate, late, noisy and lossy as the scene says; none while something stands before
/// it. Where a depth camera sees points that nobody can name, a tracker tells them apart: this is
/// the perfect sight of the published shape controllers, made worse at will.
class MarkerPublisher {
 public:
  /// The scene has markers. Throws std::invalid_argument where a marker is not on the object.
  MarkerPublisher(bus::MessageBus& control, const Scene& scene,
                  const object::HyperelasticPlant& plant, std::int64_t session,
                  std::int64_t start_utime);
  void start_clock(std::int64_t start_utime) { start_utime_ = start_utime; }

  /// Once a tick, with time rising: looks where that is due, sends what has arrived.
  void step(std::int64_t now_us, const object::HyperelasticPlant& plant);

 private:
  struct Reading {
    std::int64_t time_us = 0;
    Eigen::Matrix3Xd points_W;
  };
  bool is_occluded(std::int64_t now_us) const;
  void publish(const Reading& reading);

  MarkerOptions options_;
  math::Pose X_WO_;
  std::vector<object::MaterialPoint> markers_;
  sensors::Channel<Reading> channel_;
  math::Random noise_;
  std::int64_t start_utime_;
  bus::TypedPublisher<shape_observation_t> publisher_;
  bus::Stamp stamp_;
};

}  // namespace palpate::scenes
