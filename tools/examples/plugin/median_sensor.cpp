#include "median_sensor.hpp"

#include <algorithm>
#include <stdexcept>

namespace example {

using palpate::Status;

palpate::config::OptionTable<MedianSensor::Options> MedianSensor::table() {
  return palpate::config::OptionTable<Options>()
      .integer("samples", "of the median; odd", {1, kMostSamples}, &Options::samples)
      .integer("tare_samples", "of a tare", {1, 100000}, &Options::tare_samples)
      .number("max_age_ms", "ms", "of the latest reading", {1, 1e4}, &Options::max_age, 1e-3)
      .number("force_deviation", "N", "standard deviation of each axis", {0, 100},
              &Options::force_deviation);
}

MedianSensor::MedianSensor(const Options& options)
    : options_(options), tare_(options.tare_samples) {
  if (options.samples % 2 == 0) throw std::invalid_argument("samples must be odd");
  tare_.start();
}

void MedianSensor::reset() {
  count_ = next_ = 0;
  tare_.reset();
  tare_.start();
}

palpate::UpdateResult MedianSensor::update(const palpate::sensing::Signals& signals,
                                           palpate::sensing::ContactSet& contacts) {
  const auto& stream = signals.force_torque;
  for (int i = 0; i < stream.fresh_count; ++i) {
    const palpate::math::Vector6d reading = stream.fresh[i].F_S.vector();
    if (!reading.allFinite()) continue;
    last_[next_] = reading;
    next_ = (next_ + 1) % options_.samples;
    count_ = std::min(count_ + 1, options_.samples);
    tare_.update(reading);
  }
  if (count_ < options_.samples) return {Status::kDegraded, "too few readings for a median"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "force-torque reading is too old"};
  if (!tare_.is_known()) return {Status::kDegraded, "taring"};

  palpate::sensing::Contact contact;
  contact.source = palpate::sensing::Source::kWrist0;
  contact.wrench = palpate::math::Wrench::from(median() - tare_.offset());
  contact.force_deviation = options_.force_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

palpate::math::Vector6d MedianSensor::median() const {
  palpate::math::Vector6d result;
  std::array<double, kMostSamples> values;
  const auto end = values.begin() + options_.samples;
  const auto middle = values.begin() + options_.samples / 2;
  for (int axis = 0; axis < 6; ++axis) {
    for (int i = 0; i < options_.samples; ++i) values[i] = last_[i][axis];
    std::nth_element(values.begin(), middle, end);
    result[axis] = *middle;
  }
  return result;
}

}  // namespace example
