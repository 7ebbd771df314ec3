#pragma once

#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {

/// What a study comes to: one row a method under each level of model error, over all applications
/// and seeds. Shape errors at the states: medians over runs, with their 95 % intervals; a feature's
/// errors alike, and the shares of runs that came within a distance of the target and stayed. A run
/// that failed reached nothing.
ReportTable overview_table(const StudyPlan& plan, const std::vector<StudyResult>& results);

/// One row a run, RFC 4180: what it was, and every number of its scores.
void write_runs_csv(const std::vector<StudyResult>& results, std::ostream& out);

}  // namespace palpate::studies
