#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "sim/camera/shape_camera.hpp"

namespace palpate::camera {

/// A ShapeCamera that draws in a thread of its own, one picture at a time, so that a simulation can
/// go on meanwhile. To be used by one thread.
class BackgroundCamera {
 public:
  /// Readings have `most` points at most. Throws as ShapeCamera does.
  BackgroundCamera(const ShapeCameraOptions& options, int most);
  ~BackgroundCamera();
  BackgroundCamera(const BackgroundCamera&) = delete;
  BackgroundCamera& operator=(const BackgroundCamera&) = delete;

  /// True from submit() until collect() has handed the reading out.
  bool busy() const { return busy_; }

  /// Begins a picture of `bodies`. Throws std::logic_error where the camera is busy.
  void submit(std::vector<Body> bodies, const math::Random& random);

  /// The reading of the picture submitted. Nothing where there is none or, without `wait`, where it
  /// is not ready. Throws what went wrong in drawing it.
  std::optional<ShapeReading> collect(bool wait);

 private:
  struct Job {
    std::vector<Body> bodies;
    math::Random random;
  };
  void work(const ShapeCameraOptions& options, int most);
  void finish(std::optional<ShapeReading> reading, std::exception_ptr error);

  bool busy_ = false;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::optional<Job> job_;
  std::optional<ShapeReading> reading_;
  std::exception_ptr error_;
  bool built_ = false;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace palpate::camera
