#include "rt/registry/contact_fallback.hpp"

#include <algorithm>

namespace palpate::registry {

bool are_plausible(const contact::ContactLoads& loads) noexcept {
  constexpr double kLargest = 1e9;  // N; a plausible wrench with a short lever arm stays below it
  return std::all_of(loads.loads.begin(), loads.loads.end(), [](const contact::NodalLoad& load) {
    return load.force.allFinite() && load.force.lpNorm<Eigen::Infinity>() <= kLargest;
  });
}

int ContactFallback::max_nodes() const noexcept {
  return std::max(first_->max_nodes(), second_->max_nodes());
}

void ContactFallback::distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                                 contact::ContactLoads& out) noexcept {
  if (!in_use_) {
    first_->distribute(contact, positions, out);
    in_use_ = !are_plausible(out);
  }
  if (in_use_) second_->distribute(contact, positions, out);
}

}  // namespace palpate::registry
