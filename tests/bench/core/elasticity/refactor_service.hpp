#pragma once

#include <optional>
#include <string>

#include "core/elasticity/deformation_model.hpp"
#include "rt/loop/background_worker.hpp"
#include "tests/bench/core/elasticity/samples.hpp"

namespace palpate::bench {

/// Schedule of a model's refactorisations.
struct RefactorPolicy {
  enum Kind { kBackground, kDelayed, kNever };
  Kind kind = kBackground;
  int delay = 10;  // steps, of kDelayed

  /// "background", "every-N" or "never"; throws std::invalid_argument for anything else.
  static RefactorPolicy parse(const std::string& text);
  std::string text() const;
};

/// Executes the refactorisations that a model requests, and measures their time.
///   background  by the daemon's worker thread;
///   every-N     at most one in N steps: run immediately, outside the step's time, and installed N
///               steps after its snapshot, like a background thread of that latency (repeatable);
///   never       not after the first.
class RefactorService {
 public:
  explicit RefactorService(const RefactorPolicy& policy);

  /// Before a step, inside its time: installs a completed one.
  void collect(elasticity::DeformationModel& model, long step);
  /// After a step, inside its time: takes the snapshot.
  void request(elasticity::DeformationModel& model, long step);
  /// Outside the step's time.
  void run_here();

  long count() const { return installed_; }
  const Samples& wall() const { return wall_; }  // s per run
  const Samples& cpu() const { return cpu_; }
  /// Steps since the snapshot of the factor in use.
  long factor_age(long step) const { return step - snapshot_in_use_; }

 private:
  struct Job {
    elasticity::Refactorisation* work = nullptr;
    long snapshot = 0;
    double wall = 0, cpu = 0;
    void run() noexcept;
  };
  void install(elasticity::DeformationModel& model);

  RefactorPolicy policy_;
  std::optional<loop::BackgroundWorker> worker_;
  Job job_;
  bool is_run_ = false;
  long snapshot_in_use_ = 0;
  long installed_ = 0;
  Samples wall_{100000}, cpu_{100000};
};

}  // namespace palpate::bench
