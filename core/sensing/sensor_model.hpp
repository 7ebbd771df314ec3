#pragma once

#include "core/sensing/sequence_executor.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Who measured a contact, and in which frame its location and wrench stand.
enum class Source { kWrist0, kWrist1, kFinger0, kFinger1, kFinger2, kFinger3, kFinger4, kManual };

/// A wrench on the object. Wrist sources: about the origin of S, in S. Finger sources: at
/// `location` in T. Manual: at a rest point, in O.
struct Contact {
  Source source = Source::kManual;
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m
  math::Wrench wrench;                                 // acting on the object, about `location`
  double force_deviation = 0;                          // N, standard deviation of each axis
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

enum class Status { kOk, kDegraded, kFault };

/// Outcome of one update. `reason` is a string literal.
struct UpdateResult {
  Status status = Status::kOk;
  const char* reason = "";
};

/// What a sensor model hands to the one that takes its place while the loop runs: its offset at
/// rest.
struct SensorState {
  enum class Offset {
    kUnknown,
    kReading,        // of a wrist, payload and all
    kBesidePayload,  // of a wrist, beyond what a payload explains
    kCounts,         // of a fingertip
  };
  Offset meaning = Offset::kUnknown;
  std::array<double, 24> offset{};  // N, N m; counts
};

/// Raw signals to contact wrenches in the sensor's frame. update() neither allocates nor throws.
class SensorModel {
 public:
  virtual ~SensorModel() = default;
  virtual UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept = 0;
  /// Tare: what is read now (averaged over the next samples) becomes zero contact.
  virtual void zero() noexcept {}
  virtual void reset() noexcept {}
  virtual SensorState save() const noexcept { return {}; }
  /// Goes on from a state. One of another meaning is not taken, and this model begins as at a
  /// start; false where it is even that of another kind of sensor.
  virtual bool restore(const SensorState& state) noexcept {
    return state.meaning == SensorState::Offset::kUnknown;
  }
  /// What runs its learned models, for reports: index 0, 1, ...; nullptr beyond the last.
  virtual const Executor* executor(int /*index*/) const noexcept { return nullptr; }
};

}  // namespace palpate::sensing
