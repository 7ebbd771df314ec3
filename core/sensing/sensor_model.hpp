#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "core/math/filter.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/sequence_executor.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Sensor that measured a contact; determines the frame of its location and wrench.
enum class Source { kWrist0, kWrist1, kFinger0, kFinger1, kFinger2, kFinger3, kFinger4, kManual };

inline bool is_wrist(Source source) noexcept {
  return source == Source::kWrist0 || source == Source::kWrist1;
}
/// Whether the source is the wrist of arm 0 or 1.
inline bool is_wrist(Source source, int arm) noexcept {
  return source == (arm == 1 ? Source::kWrist1 : Source::kWrist0);
}

/// Contact wrench on the object. Wrist sources: about the origin of S, in S. Finger sources: at
/// `location` in T. Manual: at a rest point, in O.
struct Contact {
  Source source = Source::kManual;
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m
  math::Wrench wrench;                                 // wrench on the object, about `location`
  double force_deviation = 0;                          // N, standard deviation of each axis
  /// N m, likewise of the torque about `location`; 0: not known.
  double torque_deviation = 0;
  /// Covariance of the lasting errors of the wrench (N, N m, about `location`), which no mean of
  /// many readings removes, where they differ by direction; zero: not known.
  math::Matrix6d covariance = math::Matrix6d::Zero();
};

/// Up to eight contacts without allocation.
struct ContactSet {
  int count = 0;
  std::array<Contact, 8> contacts{};

  bool push(const Contact& contact) noexcept {
    if (count == static_cast<int>(contacts.size())) return false;
    contacts[count++] = contact;
    return true;
  }
};

/// State that a sensor model hands over to its replacement while the loop runs: its offset at rest.
struct SensorState {
  enum class Offset {
    kUnknown,
    kReading,         // wrist reading, including the payload
    kWithoutPayload,  // wrist reading minus the payload's wrench
    kCounts,          // fingertip counts
    kForce,           // force of a fingertip
    kJointTorque,     // external torque of each joint
  };
  Offset meaning = Offset::kUnknown;
  std::array<double, 24> offset{};  // N, N m; counts
};

/// Converts raw signals to contact wrenches in the sensor's frame. update() neither allocates nor
/// throws.
class SensorModel {
 public:
  virtual ~SensorModel() = default;
  virtual UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept = 0;
  /// Tare: the mean of the next samples becomes zero contact.
  virtual void zero() noexcept {}
  virtual void reset() noexcept {}
  virtual SensorState save() const noexcept { return {}; }
  /// Continues from a state. A state of different meaning is ignored, and this model starts from
  /// its initial state; returns false if the state belongs to another kind of sensor.
  virtual bool restore(const SensorState& state) noexcept {
    return state.meaning == SensorState::Offset::kUnknown;
  }
  /// Executor of learned model 0, 1, ..., for reports; nullptr beyond the last.
  virtual const Executor* executor(int /*index*/) const noexcept { return nullptr; }
};

/// Converts the offset to and from the state that a model hands over.
template <int kSize>
SensorState save(const math::Tare<kSize>& tare, SensorState::Offset meaning) noexcept {
  SensorState state;
  static_assert(kSize <= std::tuple_size_v<decltype(state.offset)>);
  if (!tare.is_known()) return state;
  state.meaning = meaning;
  std::copy_n(tare.offset().data(), kSize, state.offset.begin());
  return state;
}

template <int kSize>
bool restore(const SensorState& state, SensorState::Offset meaning,
             math::Tare<kSize>& tare) noexcept {
  using Offset = SensorState::Offset;
  if (state.meaning == Offset::kUnknown) return true;
  if (state.meaning != meaning)
    return (state.meaning == Offset::kCounts) == (meaning == Offset::kCounts);
  const Eigen::Map<const typename math::Tare<kSize>::Vector> offset(state.offset.data());
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

  math::Tare<kSize> tare_;
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
