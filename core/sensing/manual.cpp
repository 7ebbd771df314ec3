#include "core/sensing/manual.hpp"

#include "core/math/option_check.hpp"

namespace palpate::sensing {

Manual::Manual(const Options& options) : options_(options) {
  math::check_positive(options.expires_after, "expires_after");
  math::check_positive(options.max_force, "max_force");
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
