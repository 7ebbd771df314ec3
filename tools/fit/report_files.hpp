#pragma once

#include <filesystem>
#include <ostream>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// The material as YAML: the fit under `material:` (model by its name, constants and other shared
/// parameters, SI units; undetermined parameters are omitted and named under `undetermined`), 95 %
/// intervals under `intervals:`, and under `corotational:` the young_modulus and poisson_ratio for
/// palpated's linear model with their intervals and the strain range of their validity.
void write_material(const Job& job, const JobResult& result, std::ostream& out);

/// Every sample: recording, quantity, abscissa, measured, predicted, whether it was held out.
void write_samples(const JobResult& result, std::ostream& out);

/// Data with fit, and residuals below, by series (six at most), as PNG. False if gnuplot is not
/// installed.
bool draw_fit(const Job& job, const JobResult& result, const std::filesystem::path& picture);

/// Below `folder`, a folder for each fit (and variant) with material.yaml, samples.csv and fit.png
/// if there are at most 200 fits, and fits.csv with one line per fit.
void write_files(const Plan& plan, const std::vector<JobResult>& results,
                 const std::filesystem::path& folder);

}  // namespace palpate::fit
