#pragma once

#include <Eigen/Core>
#include <stdexcept>

namespace palpate::sensing {

/// The offset of a sensor at rest: mean of the next `samples` samples after each start(). Until the
/// mean is complete the offset before it stands, so that taring again leaves no gap.
template <int kSize>
class Tare {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit Tare(int samples) : samples_(samples) {
    if (samples < 1) throw std::invalid_argument("tare: samples must be at least 1");
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

  /// Forgets the offset.
  void reset() noexcept {
    remaining_ = 0;
    known_ = false;
    offset_.setZero();
  }

  bool is_known() const noexcept { return known_; }
  bool is_running() const noexcept { return remaining_ > 0; }
  const Vector& offset() const noexcept { return offset_; }  // zero where not known

 private:
  int samples_;
  int remaining_ = 0;
  bool known_ = false;
  Vector sum_ = Vector::Zero();
  Vector offset_ = Vector::Zero();
};

}  // namespace palpate::sensing
