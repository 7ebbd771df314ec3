#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// Failed fits and the reasons; of those by `each`, the number and the first. False if a single fit
/// failed, or more than a tenth of those by `each`.
bool print_failures(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out);

/// Whether a derivative deviates from differences by more than kGradientTolerance.
bool has_wrong_gradient(const std::vector<JobResult>& results);

/// All results with every sample, in SI units.
nlohmann::json to_json(const Plan& plan, const std::vector<JobResult>& results);

/// The material as YAML: the fit under `material:` (model by its name, constants and other shared
/// parameters, SI units; undetermined parameters are omitted and named under `undetermined`), 95 %
/// intervals under `intervals:`, and under `corotational:` the young_modulus and poisson_ratio for
/// palpated's linear model with their intervals and the strain range of their validity.
void write_material(const Job& job, const JobResult& result, std::ostream& out);

/// material.yaml in a folder for each fit below `folder` (in `folder` itself if there is one fit),
/// unless there are more than 200.
void write_materials(const Plan& plan, const std::vector<JobResult>& results,
                     const std::filesystem::path& folder);

/// The results as text, by tools/fit/report_fits.py: a summary of several fits; of one, or with
/// `details`, its parameters, series and findings. Unless `folder` is empty, also writes there
/// fits.json (`json`), fits.csv and for each fit with a folder samples.csv and fit.png. Throws
/// Interrupted and std::runtime_error.
std::string make_report(const nlohmann::json& json, const std::filesystem::path& folder,
                        bool details);

}  // namespace palpate::fit
