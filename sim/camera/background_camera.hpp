#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "sim/camera/shape_camera.hpp"

namespace palpate::camera {

/// A ShapeCamera that renders in its own thread, one image at a time, so that a simulation can
/// continue meanwhile. To be used by one thread.
class BackgroundCamera {
 public:
  /// Readings have at most `most` points. Throws as ShapeCamera does.
  BackgroundCamera(const ShapeCameraOptions& options, int most);
  ~BackgroundCamera();
  BackgroundCamera(const BackgroundCamera&) = delete;
  BackgroundCamera& operator=(const BackgroundCamera&) = delete;

  /// True from submit() until collect() has returned the reading.
  bool busy() const { return busy_; }

  /// Begins an image of `bodies`. Throws std::logic_error if the camera is busy.
  void submit(std::vector<Body> bodies, const math::Random& random);

  /// The reading of the submitted image. Empty if there is none or, without `wait`, if it is not
  /// ready. Rethrows an error of the rendering thread.
  std::optional<ShapeReading> collect(bool wait);

 private:
  struct Job {
    std::vector<Body> bodies;
    math::Random random;
  };
  void work(const ShapeCameraOptions& options, int most);
  void finish(std::optional<ShapeReading> reading, std::exception_ptr error);

  bool busy_ = false;
  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::optional<Job> job_;
  std::optional<ShapeReading> reading_;
  std::exception_ptr error_;
  bool built_ = false;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace palpate::camera
