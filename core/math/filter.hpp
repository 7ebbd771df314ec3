#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <vector>

#include "core/math/option_check.hpp"

namespace palpate::math {

/// Mean of the last `samples` vectors (of all vectors so far while there are fewer).
template <int kSize>
class MovingAverage {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit MovingAverage(int samples) {
    if (samples < 1) throw std::invalid_argument("moving average: samples must be at least 1");
    ring_.assign(samples, Vector::Zero());
  }

  const Vector& update(const Vector& x) noexcept {
    sum_ += x - ring_[next_];
    since_wrap_ += x;
    ring_[next_] = x;
    if (count_ < size()) ++count_;
    if (++next_ == size()) {
      // The running sum accumulates rounding errors; at each wrap it is replaced by the sum since
      // the last wrap.
      next_ = 0;
      sum_ = since_wrap_;
      since_wrap_.setZero();
    }
    mean_ = sum_ / count_;
    return mean_;
  }

  const Vector& value() const noexcept { return mean_; }
  bool full() const noexcept { return count_ == size(); }
  int size() const noexcept { return static_cast<int>(ring_.size()); }

  void reset() noexcept {
    for (Vector& x : ring_) x.setZero();
    sum_.setZero();
    since_wrap_.setZero();
    mean_.setZero();
    next_ = count_ = 0;
  }

 private:
  std::vector<Vector> ring_;
  Vector sum_ = Vector::Zero();
  Vector since_wrap_ = Vector::Zero();
  Vector mean_ = Vector::Zero();
  int next_ = 0;
  int count_ = 0;
};

/// First-order low-pass y += alpha (x - y), 0 < alpha <= 1; initialised with the first sample.
template <int kSize>
class ExponentialAverage {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit ExponentialAverage(double alpha) : alpha_(alpha) {
    if (!(alpha > 0 && alpha <= 1)) {
      throw std::invalid_argument("exponential average: alpha must lie in (0, 1]");
    }
  }

  const Vector& update(const Vector& x) noexcept {
    if (started_) {
      value_ += alpha_ * (x - value_);
    } else {
      value_ = x;
      started_ = true;
    }
    return value_;
  }

  const Vector& value() const noexcept { return value_; }

  void reset() noexcept {
    started_ = false;
    value_.setZero();
  }

 private:
  double alpha_;
  bool started_ = false;
  Vector value_ = Vector::Zero();
};

/// Returns the input of `samples` updates ago, 0 or more; the first sample while there is none that
/// old.
template <int kSize>
class DelayLine {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit DelayLine(int samples) {
    if (samples < 0) throw std::invalid_argument("delay line: samples must not be negative");
    ring_.assign(samples + 1, Vector::Zero());
  }

  const Vector& update(const Vector& x) noexcept {
    if (!started_) {
      for (Vector& y : ring_) y = x;
      started_ = true;
    }
    ring_[next_] = x;
    next_ = next_ + 1 == static_cast<int>(ring_.size()) ? 0 : next_ + 1;
    return ring_[next_];
  }

  const Vector& value() const noexcept { return ring_[next_]; }

  void reset() noexcept {
    started_ = false;
    next_ = 0;
    for (Vector& y : ring_) y.setZero();
  }

 private:
  std::vector<Vector> ring_;
  int next_ = 0;
  bool started_ = false;
};

/// Offset of a sensor at rest: mean of the next `samples` samples after each start(). Until the
/// mean is complete the previous offset remains valid, so that repeated taring causes no gap.
template <int kSize>
class Tare {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit Tare(int samples) : samples_(samples) {
    check_option(samples >= 1, "tare_samples", samples, "at least 1");
  }

  void start() noexcept {
    remaining_ = samples_;
    sum_.setZero();
  }

  void update(const Vector& x) noexcept {
    if (remaining_ == 0) return;
    sum_ += x;
    if (--remaining_ > 0) return;
    offset_ = sum_ / samples_;
    known_ = true;
  }

  /// Clears the offset.
  void reset() noexcept {
    remaining_ = 0;
    known_ = false;
    offset_.setZero();
  }

  /// Sets the offset, e.g. one handed over by the replaced model.
  void set(const Vector& offset) noexcept {
    reset();
    offset_ = offset;
    known_ = true;
  }

  bool is_known() const noexcept { return known_; }
  bool is_running() const noexcept { return remaining_ > 0; }
  const Vector& offset() const noexcept { return offset_; }  // zero if not known

 private:
  int samples_;
  int remaining_ = 0;
  bool known_ = false;
  Vector sum_ = Vector::Zero();
  Vector offset_ = Vector::Zero();
};

}  // namespace palpate::math
