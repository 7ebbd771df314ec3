#include "core/sensing/biotac_linear.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::sensing {

BiotacLinear::BiotacLinear(const Options& options)
    : options_(options), tare_(options.tare_samples) {
  if (options.finger < 0 || options.finger > 4)
    throw std::invalid_argument("finger must be 0 to 4");
  if (std::abs(options.localization.polarity) != 1)
    throw std::invalid_argument("polarity must be 1 or -1");
  if (options.localization.threshold < 0 || !(options.localization.saturation > 0))
    throw std::invalid_argument("threshold must not be negative, saturation must be above 0");
  if (options.release_force < 0 || options.contact_force < options.release_force)
    throw std::invalid_argument("contact_force must not be below release_force");
  if (!(options.max_age > 0)) throw std::invalid_argument("max_age must be above 0");
  const LinearTactileModel& model = options.model;
  if (!model.matrix.allFinite() || !model.offset.allFinite() || !model.place.allFinite())
    throw std::invalid_argument("the model's numbers must be finite");
  const Eigen::Index count = feature_count(model.features);
  if (model.matrix.cols() != count || (model.place.size() > 0 && model.place.cols() != count))
    throw std::invalid_argument("the model wants one column a feature");
  tare_.start();
}

void BiotacLinear::reset() noexcept {
  tare_.reset();
  tare_.start();
  has_inputs_ = in_contact_ = has_location_ = false;
  placeless_.reset();
}

UpdateResult BiotacLinear::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.biotac[options_.finger];
  for (int i = 0; i < stream.fresh_count; ++i) {
    const TactileInputs raw = tactile_inputs(stream.fresh[i]);
    if (!raw.allFinite()) {
      ++skipped_;
      continue;
    }
    tare_.update(raw);
    inputs_ = raw - tare_.offset();
    has_inputs_ = true;
  }

  if (stream.freshness == Freshness::kNoData || !has_inputs_)
    return {Status::kDegraded, "no tactile sample yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "tactile sample is too old"};
  if (!tare_.is_known()) return {Status::kDegraded, "taring"};

  const Eigen::Vector3d force = options_.model.force(inputs_);
  const double size = force.norm();
  in_contact_ = size > (in_contact_ ? options_.release_force : options_.contact_force);
  if (!in_contact_) {
    has_location_ = false;
    placeless_.reset();
    return {};
  }
  const Localization found = locate_contact(inputs_.head<kElectrodeCount>(), options_.localization);
  if (found.active > 0) {
    location_ = options_.model.place.size() > 0 ? options_.model.location(inputs_) : found.location;
    has_location_ = true;
  }
  if (!has_location_) return placeless_.judge(stream.fresh_count);

  Contact contact;
  contact.source = static_cast<Source>(static_cast<int>(Source::kFinger0) + options_.finger);
  contact.location = location_;
  contact.wrench.force = force;
  contact.force_deviation = options_.force_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
