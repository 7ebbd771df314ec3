#pragma once

#include <cstdint>

#include "core/elasticity/deformation_model.hpp"
#include "rt/loop/background_worker.hpp"

namespace palpate::daemon {

/// Runs the factorisations requested by the deformation model in a background thread. A result is
/// installed as soon as it is available or, in deterministic mode, `delay` cycles after the
/// request, waiting if necessary, so that results do not depend on scheduling.
class Refactoring {
 public:
  /// `delay` < 0: as soon as available.
  explicit Refactoring(int delay) : delay_(delay) {}

  /// Called once per cycle by the loop.
  void service(elasticity::DeformationModel& model, std::int64_t cycle) noexcept {
    if (delay_ < 0 || cycle >= due_) {
      void* done = delay_ < 0 ? worker_.finished() : worker_.wait();
      if (done != nullptr) of_->install(*static_cast<elasticity::Refactorisation*>(done));
    }
    if (worker_.busy() || paused_) return;
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      worker_.submit(
          [](void* argument) noexcept {
            static_cast<elasticity::Refactorisation*>(argument)->run();
          },
          job);
      of_ = &model;
      due_ = cycle + delay_;
    }
  }

  /// No factorisation is started while paused.
  void pause(bool paused) noexcept { paused_ = paused; }
  bool idle() const noexcept { return !worker_.busy(); }

 private:
  int delay_;
  bool paused_ = false;
  elasticity::DeformationModel* of_ = nullptr;  // model of the job, also while a fallback runs
  loop::BackgroundWorker worker_;
  std::int64_t due_ = 0;
};

}  // namespace palpate::daemon
