#include "core/sensing/fingertip.hpp"

#include "core/math/option_check.hpp"

namespace palpate::sensing {

Fingertip::Fingertip(const Options& options) : TaredModel(options.tare_samples), options_(options) {
  math::check_option(options.finger >= 0 && options.finger <= 4, "finger", options.finger,
                     "0 to 4");
  math::check_not_negative(options.release_force, "release_force");
  math::check_option(options.contact_force >= options.release_force, "contact_force",
                     options.contact_force,
                     "at least release_force, " + std::to_string(options.release_force));
  math::check_positive(options.max_age, "max_age");
  math::check_positive(options.max_place_deviation, "max_place_deviation");
  math::check_not_negative(options.force_deviation, "force_deviation");
  if (options.tare_at_start) tare_.start();
}

void Fingertip::reset() noexcept {
  in_contact_ = false;
  tare_.reset();
  if (options_.tare_at_start) tare_.start();
}

UpdateResult Fingertip::update(const Signals& signals, ContactSet& contacts) noexcept {
  const Stream<FingertipContact, 4>& stream = signals.fingertip[options_.finger];
  for (int i = 0; i < stream.fresh_count; ++i) {
    const FingertipContact& sample = stream.fresh[i];
    if (!sample.force_T.allFinite()) {
      ++skipped_;
      continue;
    }
    if (!sample.touches) tare_.update(sample.force_T);
  }
  if (stream.freshness == Freshness::kNoData) return {Status::kDegraded, "no tactile sample yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "tactile sample is too old"};
  if (options_.tare_at_start && !tare_.is_known()) return {Status::kDegraded, "taring"};

  const FingertipContact& sample = stream.latest;
  const Eigen::Vector3d force = sample.force_T - tare_.offset();
  const double size = force.norm();
  in_contact_ =
      sample.touches && size > (in_contact_ ? options_.release_force : options_.contact_force);
  return in_contact_ ? report(sample, force, contacts) : UpdateResult();
}

UpdateResult Fingertip::report(const FingertipContact& sample, const Eigen::Vector3d& force,
                               ContactSet& contacts) const noexcept {
  if (force.dot(sample.normal_T) < -options_.release_force)
    return {Status::kDegraded, "the fingertip pulls: sign of force or normal?"};
  if (sample.place_deviation > options_.max_place_deviation)
    return {Status::kDegraded, "the place of the contact is not known well enough"};
  Contact contact;
  contact.source = static_cast<Source>(static_cast<int>(Source::kFinger0) + options_.finger);
  contact.location = sample.place_T;
  contact.wrench.force = force;
  contact.force_deviation =
      sample.force_deviation > 0 ? sample.force_deviation : options_.force_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
