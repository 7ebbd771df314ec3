#pragma once

#include <ostream>

#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// What the experiments of a fit find beside their residuals (Experiment::findings), as a table by
/// recording; nothing where they find nothing.
void print_findings(const Job& job, const JobResult& result, std::ostream& out);

}  // namespace palpate::fit
