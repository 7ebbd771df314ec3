#include "sim/scenes/marker_publisher.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

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
      publisher_(control, channel::kShapeObservation),
      stamp_(session) {
  for (const Eigen::Vector3d& point : options_.rest_points) markers_.push_back(plant.locate(point));
}

bool MarkerPublisher::is_occluded(std::int64_t now_us) const {
  const double now = 1e-6 * static_cast<double>(now_us);
  return std::any_of(options_.occlusions.begin(), options_.occlusions.end(),
                     [now](const Occlusion& occlusion) {
                       return now >= occlusion.at && now < occlusion.at + occlusion.duration;
                     });
}

void MarkerPublisher::publish(const Reading& reading) {
  shape_observation_t message{};
  stamp_.put(message, start_utime_ + reading.time_us);
  const Eigen::Matrix3Xf points = reading.points_W.cast<float>();
  message.count = static_cast<std::int32_t>(points.cols());
  message.deviation = std::max(kLeastDeviation, options_.noise);
  for (int i = 0; i < message.count; ++i)
    Eigen::Map<Eigen::Vector3f>(message.points[i]) = points.col(i);
  publisher_.publish(message);
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
    if (!is_occluded(now_us)) channel_.put(now_us, std::move(reading));
  }
  Reading reading;
  while (channel_.take(now_us, reading)) publish(reading);
}

}  // namespace palpate::scenes
