#pragma once

#include <filesystem>
#include <ostream>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// The material as YAML: what was fitted under `material:` (model by its name, constants and what
/// else the experiments share, SI units; parameters that the data cannot tell are left out and
/// named under `undetermined`), 95 % intervals under `intervals:`, and under `corotational:` the
/// young_modulus and poisson_ratio for palpated's linear model with their intervals and the strain
/// range that they hold for.
void write_material(const Job& job, const JobResult& result, std::ostream& out);

/// Every sample: recording, quantity, abscissa, measured, predicted, whether it was held out.
void write_samples(const JobResult& result, std::ostream& out);

/// Data against fit and residuals below each other, by series (six at most), as PNG. False where
/// gnuplot is not installed.
bool draw_fit(const Job& job, const JobResult& result, const std::filesystem::path& picture);

/// Below `folder`, a folder for each fit (and variant) with material.yaml, samples.csv and fit.png
/// where there are at most 200 fits, and fits.csv with a line a fit.
void write_files(const Plan& plan, const std::vector<JobResult>& results,
                 const std::filesystem::path& folder);

}  // namespace palpate::fit
