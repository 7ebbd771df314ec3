#pragma once

#include <memory>

#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::faults {

/// A sensor model with injectable faults; otherwise it forwards to the wrapped model.
class FaultySensor : public sensing::SensorModel {
 public:
  enum class Trouble { kNone, kError, kBadNumbers };

  explicit FaultySensor(std::unique_ptr<sensing::SensorModel> good) : good_(std::move(good)) {}

  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override {
    const int before = contacts.count;
    const UpdateResult result = good_->update(signals, contacts);
    if (trouble == Trouble::kError) return {Status::kFault, "has failed"};
    for (int i = before; trouble == Trouble::kBadNumbers && i < contacts.count; ++i)
      (number < 3 ? contacts.contacts[i].wrench.force[number]
                  : contacts.contacts[i].wrench.torque[number - 3]) = value;
    return result;
  }
  void zero() noexcept override { good_->zero(); }
  void reset() noexcept override { good_->reset(); }
  sensing::SensorState save() const noexcept override { return good_->save(); }
  bool restore(const sensing::SensorState& state) noexcept override {
    return good_->restore(state);
  }

  /// Releases the wrapped model; do not use the object afterwards.
  std::unique_ptr<sensing::SensorModel> release() { return std::move(good_); }

  Trouble trouble = Trouble::kNone;
  int number = 0;  // of the wrench, 0 to 5, that is replaced by `value`
  double value = 0;

 private:
  std::unique_ptr<sensing::SensorModel> good_;
};

}  // namespace palpate::faults
