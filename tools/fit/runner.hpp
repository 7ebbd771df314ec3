#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/fit/experiments/effective.hpp"
#include "tools/fit/fit.hpp"
#include "tools/fit/gradient_check.hpp"
#include "tools/fit/plan.hpp"

namespace palpate::fit {

struct RunOptions {
  std::filesystem::path data;
  std::filesystem::path checkpoint;  // empty: none
  bool resumes = false;
  bool checks_gradients = false;
  bool compares_numeric = false;  // also solves each fit with differences
  int threads = 1;
  /// Completed fraction of the work, and a short description; called from any thread, one at a
  /// time.
  std::function<void(double fraction, const std::string& note)> progress;
};

/// The search by differences compared with that by derivatives, from the same start.
struct NumericComparison {
  double seconds = 0, seconds_numeric = 0;
  long evaluations = 0, evaluations_numeric = 0;  // of experiments, with derivatives or without
  double difference = 0;                          // largest of a coordinate at the end
};

/// Result of a job: a fit, or the reason why there is none.
struct JobResult {
  std::string error;  // empty: success
  std::unique_ptr<Problem> problem;
  Fit fit;
  std::string material;
  std::array<double, 2> strain_range{};
  std::optional<EffectiveMaterial> effective;
  std::vector<GradientCheck> gradients;
  std::optional<NumericComparison> numeric;
};

/// A job's experiments as a problem. Throws config::Error, import::CsvError and
/// std::invalid_argument.
std::unique_ptr<Problem> make_problem(const Job& job, const std::filesystem::path& data);

/// Every job of the plan, over `threads` (for one job, over its recordings). Errors of individual
/// jobs are in their results; if there is only one job they are thrown.
std::vector<JobResult> run(const Plan& plan, const RunOptions& options);

}  // namespace palpate::fit
