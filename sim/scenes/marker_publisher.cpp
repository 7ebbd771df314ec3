#include "sim/scenes/marker_publisher.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "sim/scenes/camera_publisher.hpp"

namespace palpate::scenes {
namespace {

/// A message must report a standard deviation; for a perfect tracker it is this, m.
constexpr double kLeastDeviation = 1e-6;

}  // namespace

MarkerPublisher::MarkerPublisher(bus::MessageBus& control, const Scene& scene,
                                 const object::HyperelasticPlant& plant, std::int64_t session,
                                 std::int64_t start_utime)
    : options_(*scene.markers),
      X_WO_(scene.X_WO),
      channel_(options_.timing, math::Random(scene.seed, "markers")),
      noise_(scene.seed, "marker noise"),
      start_utime_(start_utime),
      publisher_(control, channel::kShapeObservation, session) {
  for (const Eigen::Vector3d& point : options_.rest_points) markers_.push_back(plant.locate(point));
}

void MarkerPublisher::step(std::int64_t now_us, const object::HyperelasticPlant& plant) {
  if (channel_.due(now_us)) {
    Reading reading{now_us, Eigen::Matrix3Xd(3, markers_.size())};
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      Eigen::Vector3d error;
      for (int k = 0; k < 3; ++k) error[k] = options_.noise * noise_.normal();
      reading.points_W.col(i) = X_WO_ * markers_[i].interpolate(plant.positions()) + error;
    }
    // Noise is drawn in every case, so that an occlusion does not change the noise of later
    // readings.
    if (!is_occluded(options_.occlusions, now_us)) channel_.put(now_us, std::move(reading));
  }
  Reading reading;
  while (channel_.take(now_us, reading)) {
    auto message = make_observation(reading.points_W, std::max(kLeastDeviation, options_.noise));
    publisher_.publish(message, start_utime_ + reading.time_us);
  }
}

}  // namespace palpate::scenes
