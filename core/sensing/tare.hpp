#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "core/math/option_check.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Offset of a sensor at rest: mean of the next `samples` samples after each start(). Until the
/// mean is complete the previous offset remains valid, so that repeated taring causes no gap.
template <int kSize>
class Tare {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;

  explicit Tare(int samples) : samples_(samples) {
    math::check_option(samples >= 1, "tare_samples", samples, "at least 1");
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

/// Converts the offset to and from the state that a model hands over.
template <int kSize>
SensorState save(const Tare<kSize>& tare, SensorState::Offset meaning) noexcept {
  SensorState state;
  static_assert(kSize <= std::tuple_size_v<decltype(state.offset)>);
  if (!tare.is_known()) return state;
  state.meaning = meaning;
  std::copy_n(tare.offset().data(), kSize, state.offset.begin());
  return state;
}

template <int kSize>
bool restore(const SensorState& state, SensorState::Offset meaning, Tare<kSize>& tare) noexcept {
  using Offset = SensorState::Offset;
  if (state.meaning == Offset::kUnknown) return true;
  if (state.meaning != meaning)
    return (state.meaning == Offset::kCounts) == (meaning == Offset::kCounts);
  const Eigen::Map<const typename Tare<kSize>::Vector> offset(state.offset.data());
  if (offset.allFinite()) tare.set(offset);
  return true;
}

/// Sensor model with an offset at rest that zero() measures and that a replacement takes over.
template <int kSize, SensorState::Offset kMeaning>
class TaredModel : public SensorModel {
 public:
  void zero() noexcept override { tare_.start(); }
  SensorState save() const noexcept override { return sensing::save(tare_, kMeaning); }
  bool restore(const SensorState& state) noexcept override {
    return sensing::restore(state, kMeaning, tare_);
  }

  /// Samples rejected since construction because a number was not finite.
  std::int64_t skipped() const noexcept { return skipped_; }

 protected:
  explicit TaredModel(int tare_samples) : tare_(tare_samples) {}

  Tare<kSize> tare_;
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
