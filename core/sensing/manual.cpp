#include "core/sensing/manual.hpp"

#include <stdexcept>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

Manual::Manual(const Options& options) : options_(options) {
  math::check_option(options.expires_after > 0, "expires_after", options.expires_after, "above 0");
  math::check_option(options.max_force > 0, "max_force", options.max_force, "above 0");
}

UpdateResult Manual::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.manual;
  if (stream.freshness == Freshness::kNoData || stream.age > options_.expires_after) return {};
  const ManualForce& manual = stream.latest;
  if (!manual.force_O.allFinite() || !manual.rest_point_O.allFinite())
    return {Status::kDegraded, "manual force is not finite"};
  const double size = manual.force_O.norm();
  if (size == 0) return {};

  Contact contact;
  contact.source = Source::kManual;
  contact.location = manual.rest_point_O;
  contact.wrench.force = manual.force_O;
  if (size > options_.max_force) contact.wrench.force *= options_.max_force / size;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
