#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// A time in which the estimator reports that its model does not explain what it measures.
struct DoubtReport {
  std::int64_t begin = 0, end = 0;  // us; end: of the log, if it lasts until then
  std::string reason;               // each that held meanwhile, once; empty if the log holds none
};

/// Reason of a report that is an external contact in ESTIMATE or UNKNOWN_CONTACT.
inline constexpr const char* kExternalContact = "external contact";

/// Whether a degraded estimation slot with this reason (HEALTH) doubts its model: not where its
/// inputs or its solver fail. An empty reason does.
bool is_doubt(const std::string& reason);

/// Times from `from` (us) on in which the estimation slot is degraded by doubt, tracks an external
/// contact, or in which DISCREPANCY is inconsistent. What began earlier begins at `from`.
std::vector<DoubtReport> doubt_reports(const log::RunLog& log, std::int64_t from);

/// The first report that begins at or after `from` (us), or that lasts then; nullptr: none.
const DoubtReport* reported_at(const std::vector<DoubtReport>& reports, std::int64_t from);

/// Whether a report lasts at `utime` (us).
bool is_reported(const std::vector<DoubtReport>& reports, std::int64_t utime);

}  // namespace palpate::studies
