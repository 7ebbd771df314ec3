#pragma once

#include <memory>

#include "core/contact/force_transformer.hpp"

namespace palpate::registry {

/// True if every load is finite and of plausible magnitude.
bool are_plausible(const contact::ContactLoads& loads) noexcept;

/// Force transformer with a fallback: if the first one returns implausible loads, the second one
/// processes the same contact and remains active until reset().
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

  /// Set-up: replaces the first transformer and returns the previous one.
  void exchange(std::unique_ptr<contact::ForceTransformer>& first) noexcept { first_.swap(first); }

 private:
  std::unique_ptr<contact::ForceTransformer> first_, second_;
  bool in_use_ = false;
};

}  // namespace palpate::registry
