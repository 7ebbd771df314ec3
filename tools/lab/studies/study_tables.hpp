#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/common/bootstrap.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {

/// A job and its result.json; null if it has none: it failed, or has not been run.
struct StudyResult {
  StudyJob job;
  nlohmann::json json;
  bool failed = false;
};

struct ReportTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // a row of one cell spans the table as a title
};

/// The model errors of an application as tables list them: all draws of a distribution are one, by
/// its name (its family).
std::vector<std::string> level_names(const StudyApplication& application);

/// "model error: all", "model error: calibrated, 100 draws: median; 90 %; worst".
std::string level_title(const StudyApplication& application, const std::string& level);

/// Whether a job belongs to a level, or to the family of draws of that name.
bool is_of_level(const StudyJob& job, const std::string& level);

/// Text of a cell: median and its 95 % interval over seeds; over draws "0.52; 0.81; 1.20": median,
/// the value that 90 % do not exceed, worst. `most_is_best`: the others are below.
std::string spread(std::vector<double> values, int decimals, bool is_drawn,
                   bool most_is_best = false);

/// Results of an application with one method and model error (is_of_level()); they differ by their
/// seed, and for a family by the draw.
std::vector<const nlohmann::json*> results_of(const StudyApplication& application,
                                              const std::vector<StudyResult>& results,
                                              const std::string& method, const std::string& level);

/// Shape, pose and cost of an application: one row per method, under each level of model error;
/// errors are means over the states (maxima of maxima), then medians over the seeds with their 95 %
/// intervals, as in all tables.
ReportTable summary_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results);

/// The same by state, with the pose error's components.
ReportTable state_table(const StudyApplication& application,
                        const std::vector<StudyResult>& results);

/// Error at rest, times, overshoot and path length of a control application.
ReportTable control_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results);

/// Shape of a replayed study: one row per method, one column per level; nodes' mean error and the
/// surfaces' Hausdorff distance, mm, means over the states, then medians over the seeds. `cap`: mm,
/// the most of any state, and what a failed run counts as. Empty without results.
ReportTable errors_table(const StudyApplication& application,
                         const std::vector<StudyResult>& results, double cap);

/// The values of the thesis, without results of ours.
ReportTable published_table(const StudyApplication& application);

/// One row per job and state, RFC 4180.
void write_states_csv(const std::vector<StudyResult>& results, std::ostream& out);

/// Summary of a study: one row per method under each level of model error, over all applications
/// and seeds. Shape errors at the states: medians over runs, with their 95 % intervals; a feature's
/// errors likewise, and the fractions of runs that came within a distance of the target and stayed.
/// A failed run counts as not having reached any target.
ReportTable overview_table(const StudyPlan& plan, const std::vector<StudyResult>& results);

/// One row per run, RFC 4180: its settings, and all its scores.
void write_runs_csv(const std::vector<StudyResult>& results, std::ostream& out);

}  // namespace palpate::studies
