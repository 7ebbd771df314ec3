#pragma once

#include <array>
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

/// How an estimate's interval came about, or why it has none.
std::string derivation(const Estimate& estimate);

/// Parameters, series, what the data cannot tell, and the co-rotational material, of one fit.
void print_details(const Job& job, const JobResult& result, std::ostream& out);

/// One line a fit by variant, and by group of several: medians and the spread between them.
void print_summary(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out);

/// Fits that failed and why; of those by `each`, how many and the first. False where one failed
/// that stands alone, or more than a tenth of those by `each`.
bool print_failures(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out);

/// Largest difference by quantity over all fits; false where one is above kGradientTolerance.
bool print_gradients(const std::vector<JobResult>& results, std::ostream& out);

/// Search by derivatives against search by differences, over all fits.
void print_comparison(const std::vector<JobResult>& results, std::ostream& out);

/// Everything that is printed, in SI units.
nlohmann::json to_json(const Plan& plan, const std::vector<JobResult>& results);

}  // namespace palpate::fit
