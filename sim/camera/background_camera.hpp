#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim/camera/shape_camera.hpp"

namespace palpate::camera {

/// A ShapeCamera that renders in the background, one image at a time, so that a simulation can
/// continue meanwhile. To be used by one thread.
class BackgroundCamera {
 public:
  /// Readings have at most `most` points. Throws as ShapeCamera does.
  BackgroundCamera(const ShapeCameraOptions& options, int most) : camera_(options), most_(most) {}
  BackgroundCamera(const BackgroundCamera&) = delete;
  BackgroundCamera& operator=(const BackgroundCamera&) = delete;

  /// True from submit() until collect() has returned the reading.
  bool busy() const { return reading_.valid(); }

  /// Begins an image of `bodies`. Throws std::logic_error if the camera is busy.
  void submit(std::vector<Body> bodies, const math::Random& random) {
    if (busy()) throw std::logic_error("the camera is still busy with the picture before");
    reading_ = std::async(std::launch::async, [this, bodies = std::move(bodies), random] {
      return camera_.look(bodies, random, most_);
    });
  }

  /// The reading of the submitted image. Empty if there is none or, without `wait`, if it is not
  /// ready. Rethrows an error of the rendering thread.
  std::optional<ShapeReading> collect(bool wait) {
    constexpr std::chrono::seconds kNow{0};
    if (!busy() || (!wait && reading_.wait_for(kNow) != std::future_status::ready))
      return std::nullopt;
    return reading_.get();
  }

 private:
  ShapeCamera camera_;
  int most_;
  std::future<ShapeReading> reading_;  // waits for its thread, before the camera goes
};

}  // namespace palpate::camera
