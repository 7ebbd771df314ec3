#include "core/sensing/fingertip_model.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::sensing {

void FingertipOptions::check() const {
  if (finger < 0 || finger > 4) throw std::invalid_argument("finger must be 0 to 4");
  if (std::abs(localization.polarity) != 1) throw std::invalid_argument("polarity must be 1 or -1");
  if (localization.threshold < 0 || !(localization.saturation > 0))
    throw std::invalid_argument("threshold must not be negative, saturation must be above 0");
  if (release_force < 0 || contact_force < release_force)
    throw std::invalid_argument("contact_force must not be below release_force");
  if (!(max_age > 0)) throw std::invalid_argument("max_age must be above 0");
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
