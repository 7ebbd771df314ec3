#include "sim/camera/background_camera.hpp"

#include <stdexcept>
#include <utility>

namespace palpate::camera {

BackgroundCamera::BackgroundCamera(const ShapeCameraOptions& options, int most) {
  // The graphics context belongs to the thread that created it, so the camera is constructed there.
  thread_ = std::thread([this, options, most] { work(options, most); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return built_ || error_; });
  if (!error_) return;
  lock.unlock();
  thread_.join();
  std::rethrow_exception(error_);
}

BackgroundCamera::~BackgroundCamera() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundCamera::submit(std::vector<Body> bodies, const math::Random& random) {
  if (busy_) throw std::logic_error("the camera is still busy with the picture before");
  busy_ = true;
  {
    const std::lock_guard lock(mutex_);
    job_ = Job{std::move(bodies), random};
  }
  changed_.notify_all();
}

std::optional<ShapeReading> BackgroundCamera::collect(bool wait) {
  if (!busy_) return std::nullopt;
  std::unique_lock lock(mutex_);
  if (wait) changed_.wait(lock, [this] { return reading_ || error_; });
  if (error_) {
    busy_ = false;
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
  if (reading_) busy_ = false;
  return std::exchange(reading_, std::nullopt);
}

void BackgroundCamera::finish(std::optional<ShapeReading> reading, std::exception_ptr error) {
  {
    const std::lock_guard lock(mutex_);
    built_ = true;
    reading_ = std::move(reading);
    error_ = std::move(error);
  }
  changed_.notify_all();
}

void BackgroundCamera::work(const ShapeCameraOptions& options, int most) {
  std::optional<ShapeCamera> camera;
  try {
    camera.emplace(options);
  } catch (...) {
    finish(std::nullopt, std::current_exception());
    return;
  }
  finish(std::nullopt, nullptr);
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || job_; });
    if (stop_) return;
    const Job job = *std::exchange(job_, std::nullopt);
    lock.unlock();
    try {
      finish(camera->look(job.bodies, job.random, most), nullptr);
    } catch (...) {
      finish(std::nullopt, std::current_exception());
    }
  }
}

}  // namespace palpate::camera
