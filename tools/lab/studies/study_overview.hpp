#pragma once

#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {

/// Summary of a study: one row per method under each level of model error, over all applications
/// and seeds. Shape errors at the states: medians over runs, with their 95 % intervals; a feature's
/// errors likewise, and the fractions of runs that came within a distance of the target and stayed.
/// A failed run counts as not having reached any target.
ReportTable overview_table(const StudyPlan& plan, const std::vector<StudyResult>& results);

/// One row per run, RFC 4180: its settings, and all its scores.
void write_runs_csv(const std::vector<StudyResult>& results, std::ostream& out);

}  // namespace palpate::studies
