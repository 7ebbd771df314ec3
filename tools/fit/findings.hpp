#pragma once

#include <ostream>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// Results of a fit's experiments in addition to their residuals (Experiment::findings), as a table
/// by recording; nothing if there are none.
void print_findings(const Job& job, const JobResult& result, std::ostream& out);

}  // namespace palpate::fit
