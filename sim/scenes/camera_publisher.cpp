#include "sim/scenes/camera_publisher.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate::scenes {
namespace {

constexpr int kMostPoints =
    sizeof(shape_observation_t::points) / sizeof(shape_observation_t::points[0]);

}  // namespace

CameraPublisher::CameraPublisher(bus::MessageBus& control, const Scene& scene,
                                 const std::vector<Arm>& arms, std::int64_t session,
                                 std::int64_t start_utime)
    : channel_(scene.sensors.camera.timing, math::Random(scene.seed, "camera")),
      delay_us_(std::lround(1e6 * scene.sensors.camera.timing.delay)),
      occlusions_(scene.occlusions),
      noise_(scene.seed, "depth"),
      scenery_(scene, arms),
      camera_(*scene.camera, kMostPoints),
      start_utime_(start_utime),
      publisher_(control, "SHAPE_OBSERVATION"),
      stamp_(session) {}

bool CameraPublisher::is_occluded(std::int64_t now_us) const {
  const double now = 1e-6 * static_cast<double>(now_us);
  return std::any_of(occlusions_.begin(), occlusions_.end(), [now](const Occlusion& occlusion) {
    return now >= occlusion.at && now < occlusion.at + occlusion.duration;
  });
}

void CameraPublisher::collect(bool wait) {
  if (auto shape = camera_.collect(wait)) channel_.put(drawn_us_, {drawn_us_, std::move(*shape)});
}

void CameraPublisher::publish(const Reading& reading) {
  shape_observation_t message{};
  stamp_.put(message, start_utime_ + reading.time_us);
  const Eigen::Matrix3Xf points = reading.shape.points_W.cast<float>();
  message.count = static_cast<std::int32_t>(points.cols());
  message.deviation = reading.shape.deviation;
  for (int i = 0; i < message.count; ++i)
    Eigen::Map<Eigen::Vector3f>(message.points[i]) = points.col(i);
  publisher_.publish(message);
}

void CameraPublisher::step(std::int64_t now_us, const std::vector<Arm>& arms,
                           const object::Plant& plant) {
  if (channel_.due(now_us)) {
    ++pictures_;
    collect(!may_lag_);
    if (is_occluded(now_us)) {
      // Marks an omitted image.
    } else if (camera_.busy()) {
      ++left_out_;
    } else {
      // The noise of an image depends only on its index, not on which images were omitted before.
      camera_.submit(scenery_.now(arms, plant), noise_.split(std::to_string(pictures_)));
      drawn_us_ = now_us;
    }
  }
  // No reading arrives before its delay has passed: waiting is needed only then.
  collect(!may_lag_ && now_us >= drawn_us_ + delay_us_);
  Reading reading;
  while (channel_.take(now_us, reading)) publish(reading);
}

}  // namespace palpate::scenes
