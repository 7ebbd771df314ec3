#include "rt/component/sensor_fallback.hpp"

namespace palpate::component {

sensing::UpdateResult SensorFallback::update(const sensing::Signals& signals,
                                             sensing::ContactSet& contacts) noexcept {
  const int others = contacts.count;
  const sensing::UpdateResult first = first_->update(signals, contacts);
  if (first.status != sensing::Status::kFault) {
    unused_.count = 0;
    second_->update(signals, unused_);
    return first;
  }
  contacts.count = others;
  const sensing::UpdateResult second = second_->update(signals, contacts);
  if (second.status != sensing::Status::kOk) return second;
  return {sensing::Status::kDegraded, reason_};
}

void SensorFallback::zero() noexcept {
  first_->zero();
  second_->zero();
}

void SensorFallback::reset() noexcept {
  first_->reset();
  second_->reset();
}

}  // namespace palpate::component
