#pragma once

#include <cstdint>
#include <optional>

#include "core/elasticity/deformation_model.hpp"
#include "rt/loop/background_worker.hpp"

namespace palpate::daemon {

/// Runs the factorisations that the deformation model asks for: in a background thread, or, in
/// deterministic mode, at once, but installed `delay` cycles later, so that nothing depends on
/// scheduling.
class Refactoring {
 public:
  /// `delay` < 0: background thread.
  explicit Refactoring(int delay) : delay_(delay) {
    if (delay_ < 0) worker_.emplace();
  }

  /// Once a cycle, by the loop.
  void service(elasticity::DeformationModel& model, std::int64_t cycle) noexcept {
    if (worker_) {
      if (auto* done = static_cast<elasticity::Refactorisation*>(worker_->finished())) {
        model.install(*done);
      }
      if (worker_->busy()) return;
      if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
        worker_->submit(
            [](void* argument) noexcept {
              static_cast<elasticity::Refactorisation*>(argument)->run();
            },
            job);
      }
      return;
    }
    if (pending_ != nullptr && cycle >= due_) {
      model.install(*pending_);
      pending_ = nullptr;
    }
    if (pending_ != nullptr) return;
    pending_ = model.wanted_refactorisation();
    if (pending_ == nullptr) return;
    pending_->run();
    due_ = cycle + delay_;
  }

 private:
  int delay_;
  std::optional<loop::BackgroundWorker> worker_;
  elasticity::Refactorisation* pending_ = nullptr;
  std::int64_t due_ = 0;
};

}  // namespace palpate::daemon
