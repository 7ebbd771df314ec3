#pragma once

#include <memory>

#include "core/contact/force_transformer.hpp"

namespace palpate::registry {

/// Whether every load is finite and one that a contact may have.
bool are_plausible(const contact::ContactLoads& loads) noexcept;

/// A force transformer with another one to fall back on: where the first gives loads that cannot
/// be, the second takes its place for the same contact, and goes on until reset().
class ContactFallback final : public contact::ForceTransformer {
 public:
  ContactFallback(std::unique_ptr<contact::ForceTransformer> first,
                  std::unique_ptr<contact::ForceTransformer> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  int max_nodes() const noexcept override;
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  contact::ContactLoads& out) noexcept override;
  void reset() noexcept { in_use_ = false; }
  bool in_use() const noexcept { return in_use_; }

  /// Set-up: puts another first one in, and gives the present one away.
  void exchange(std::unique_ptr<contact::ForceTransformer>& first) noexcept { first_.swap(first); }

 private:
  std::unique_ptr<contact::ForceTransformer> first_, second_;
  bool in_use_ = false;
};

}  // namespace palpate::registry
