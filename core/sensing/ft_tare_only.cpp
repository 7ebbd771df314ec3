#include "core/sensing/ft_tare_only.hpp"

#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

FtTareOnly::FtTareOnly(const Options& options)
    : TaredModel(options.tare_samples),
      options_(options),
      delay_(options.delay),
      average_(options.moving_average) {
  math::check_polarity(options.polarity);
  math::check_positive(options.max_age, "max_age");
  if (options.tare_at_start) tare_.start();
}

void FtTareOnly::reset() noexcept {
  tare_.reset();
  if (options_.tare_at_start) tare_.start();
  delay_.reset();
  average_.reset();
  has_reading_ = false;
}

UpdateResult FtTareOnly::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.force_torque;
  for (int i = 0; i < stream.fresh_count; ++i) {
    const math::Vector6d reading = options_.polarity * stream.fresh[i].F_S.vector();
    if (!reading.allFinite()) {
      ++skipped_;
      continue;
    }
    tare_.update(reading);
    average_.update(delay_.update(reading));
    has_reading_ = true;
  }

  if (stream.freshness == Freshness::kNoData || !has_reading_)
    return {Status::kDegraded, "no force-torque reading yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "force-torque reading is too old"};
  if (options_.tare_at_start && !tare_.is_known()) return {Status::kDegraded, "taring"};

  Contact contact;
  contact.source = options_.source;
  contact.wrench = math::Wrench::from(average_.value() - tare_.offset());
  contact.force_deviation = options_.force_deviation;
  contact.torque_deviation = options_.torque_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
