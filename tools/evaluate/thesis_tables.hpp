#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/evaluate/thesis_plan.hpp"

namespace palpate::evaluate {

/// What a value is called that nobody could read, or that a run did not give.
inline constexpr const char* kNotAvailable = "not available";

/// A job and its result.json; null where it has none.
struct ThesisResult {
  ThesisJob job;
  nlohmann::json json;
};

struct ReportTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // a row of one cell is a title across
};

/// Mean over the seeds, with the range behind it where there are several: "1.2 (1.1 to 1.4)".
std::string mean_and_range(const std::vector<double>& values, int decimals);

/// Shape, pose and cost of an application: one row a method, under each level of model error;
/// errors are means over the states (maxima of maxima).
ReportTable summary_table(const ThesisApplication& application,
                          const std::vector<ThesisResult>& results);

/// The same by state, with the pose error's components.
ReportTable state_table(const ThesisApplication& application,
                        const std::vector<ThesisResult>& results);

/// Error at rest, times, overshoot, path of a control application.
ReportTable control_table(const ThesisApplication& application,
                          const std::vector<ThesisResult>& results);

/// What the thesis gives, beside nothing of ours.
ReportTable published_table(const ThesisApplication& application);

/// One row a job and state, RFC 4180.
void write_states_csv(const std::vector<ThesisResult>& results, std::ostream& out);

}  // namespace palpate::evaluate
