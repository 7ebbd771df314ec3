#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// A value in its unit with an SI prefix: "84.3 kPa", "1.20 mm", "0.31".
std::string readable(double value, const std::string& unit);

/// "79.1 kPa to 84.3 kPa".
std::string interval_text(const std::array<double, 2>& interval, const std::string& unit);

/// How an estimate's interval was obtained, or why there is none.
std::string derivation(const Estimate& estimate);

/// Parameters, series, undetermined combinations, and the co-rotational material, of one fit.
void print_details(const Job& job, const JobResult& result, std::ostream& out);

/// One line per fit and variant, and per group of several: medians and their spread.
void print_summary(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out);

/// Failed fits and the reasons; of those by `each`, the number and the first. False if a single fit
/// failed, or more than a tenth of those by `each`.
bool print_failures(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out);

/// Largest deviation by quantity over all fits; false if one is above kGradientTolerance.
bool print_gradients(const std::vector<JobResult>& results, std::ostream& out);

/// Search with derivatives compared with search by differences, over all fits.
void print_comparison(const std::vector<JobResult>& results, std::ostream& out);

/// All printed results, in SI units.
nlohmann::json to_json(const Plan& plan, const std::vector<JobResult>& results);

/// Results of a fit's experiments in addition to their residuals (Experiment::findings), as a table
/// by recording; nothing if there are none.
void print_findings(const Job& job, const JobResult& result, std::ostream& out);

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
