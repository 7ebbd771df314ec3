#pragma once

#include "core/math/team.hpp"

namespace palpate::elasticity {

/// A team of one thread that executes the members' shares one after the other, in reverse order if
/// `backwards`. Shares that depend on each other, or write data read by another, give different
/// numbers in the two orders.
class Turns final : public math::Team {
 public:
  explicit Turns(int size, bool backwards = false) : size_(size), backwards_(backwards) {}

  int size() const noexcept override { return size_; }
  void run(math::TeamTask task) noexcept override {
    for (int k = 0; k < size_; ++k) task(backwards_ ? size_ - 1 - k : k, size_);
  }

 private:
  int size_;
  bool backwards_;
};

}  // namespace palpate::elasticity
