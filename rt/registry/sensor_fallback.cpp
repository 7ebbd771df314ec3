#include "rt/registry/sensor_fallback.hpp"

namespace palpate::registry {

bool is_plausible(const sensing::Contact& contact) noexcept {
  constexpr double kLargest = 1e6;  // m, N, N m
  return contact.location.lpNorm<Eigen::Infinity>() <= kLargest &&
         contact.wrench.force.lpNorm<Eigen::Infinity>() <= kLargest &&
         contact.wrench.torque.lpNorm<Eigen::Infinity>() <= kLargest &&
         contact.location.allFinite() && contact.wrench.force.allFinite() &&
         contact.wrench.torque.allFinite();
}

UpdateResult SensorFallback::update(const sensing::Signals& signals,
                                    sensing::ContactSet& contacts) noexcept {
  const int others = contacts.count;
  if (!in_use_) {
    const UpdateResult first = first_->update(signals, contacts);
    in_use_ = first.status == Status::kFault;
    for (int i = others; i < contacts.count; ++i)
      in_use_ = in_use_ || !is_plausible(contacts.contacts[i]);
    if (!in_use_) {
      unused_.count = 0;
      static_cast<void>(second_->update(signals, unused_));
      return first;
    }
  }
  contacts.count = others;
  const UpdateResult second = second_->update(signals, contacts);
  if (second.status != Status::kOk || reason_ == nullptr) return second;
  return {Status::kDegraded, reason_};
}

void SensorFallback::zero() noexcept {
  first_->zero();
  second_->zero();
}

void SensorFallback::reset() noexcept {
  first_->reset();
  second_->reset();
  in_use_ = false;
}

}  // namespace palpate::registry
