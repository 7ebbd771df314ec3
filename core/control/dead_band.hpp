#pragma once

namespace palpate::control {

/// Stop band with hysteresis: at rest from when both errors are inside the band until one of them
/// leaves a larger band.
class DeadBand {
 public:
  struct Options {
    double position = 1e-3;  // m
    double angle = 3.5e-3;   // rad
    double release = 1.2;    // >= 1, motion resumes outside this multiple of the band
  };

  explicit DeadBand(const Options& options) : options_(options) {}

  bool rests(double position_error, double angle_error) noexcept {
    const double factor = resting_ ? options_.release : 1.0;
    resting_ =
        position_error <= factor * options_.position && angle_error <= factor * options_.angle;
    return resting_;
  }

  void reset() noexcept { resting_ = false; }

 private:
  Options options_;
  bool resting_ = false;
};

}  // namespace palpate::control
