#include "core/sensing/fingertip_model.hpp"

#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

void FingertipOptions::check() const {
  math::check_option(finger >= 0 && finger <= 4, "finger", finger, "0 to 4");
  math::check_polarity(localization.polarity);
  math::check_not_negative(localization.threshold, "threshold");
  math::check_positive(localization.saturation, "saturation");
  math::check_not_negative(release_force, "release_force");
  math::check_option(contact_force >= release_force, "contact_force", contact_force,
                     "at least release_force, " + std::to_string(release_force));
  math::check_positive(max_age, "max_age");
}

void FingertipModel::reset_contact() noexcept {
  tare_.reset();
  tare_.start();
  in_contact_ = has_location_ = false;
  placeless_.reset();
}

void FingertipModel::detect_contact(const FingertipOptions& options, double size) noexcept {
  in_contact_ = size > (in_contact_ ? options.release_force : options.contact_force);
  if (in_contact_) return;
  has_location_ = false;
  placeless_.reset();
}

UpdateResult FingertipModel::report(const FingertipOptions& options, const Eigen::Vector3d& force,
                                    ContactSet& contacts) const noexcept {
  Contact contact;
  contact.source = static_cast<Source>(static_cast<int>(Source::kFinger0) + options.finger);
  contact.location = location_;
  contact.wrench.force = force;
  contact.force_deviation = options.force_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
