#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/lab/studies/discrepancy_reports.hpp"

namespace palpate::studies {

/// The cause (discrepancy_t) of a kind of discrepancies.yaml; CAUSE_UNKNOWN for none.
int cause_of(const std::string& kind);

/// "contact", "clamp place", ...; "unknown" for other numbers.
std::string cause_name(int cause);

/// Causes by decreasing probability as they stand at `until`: the one that the estimate is
/// corrected for, or those of the last DISCREPANCY from `from` on that ranks any (us). While there
/// is none, a tracked external contact in `reports` is the contact alone. Empty: nothing has been
/// explained.
std::vector<int> ranking_at(const log::RunLog& log, const std::vector<DoubtReport>& reports,
                            std::int64_t from, std::int64_t until);

}  // namespace palpate::studies
