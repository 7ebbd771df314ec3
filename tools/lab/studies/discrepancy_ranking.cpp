#include "tools/lab/studies/discrepancy_ranking.hpp"

#include <algorithm>
#include <iterator>

namespace palpate::studies {
namespace {

constexpr const char* kCauseNames[] = {"unknown",     "contact",          "slip",
                                       "clamp place", "clamp compliance", "uneven stiffness",
                                       "weight",      "sensor bias"};
constexpr int kCauseCount = static_cast<int>(std::size(kCauseNames));

}  // namespace

int cause_of(const std::string& kind) {
  if (kind == "table" || kind == "cylinder" || kind == "wall") return discrepancy_t::CAUSE_CONTACT;
  if (kind == "slip") return discrepancy_t::CAUSE_SLIP;
  if (kind == "shifted clamp") return discrepancy_t::CAUSE_CLAMP_PLACE;
  if (kind == "sprung clamp") return discrepancy_t::CAUSE_CLAMP_COMPLIANCE;
  if (kind == "stiffer half") return discrepancy_t::CAUSE_UNEVEN_STIFFNESS;
  if (kind == "weight") return discrepancy_t::CAUSE_WEIGHT;
  return discrepancy_t::CAUSE_UNKNOWN;
}

std::string cause_name(int cause) {
  return kCauseNames[cause >= 0 && cause < kCauseCount ? cause : 0];
}

std::vector<int> ranking_at(const log::RunLog& log, const std::vector<DoubtReport>& reports,
                            std::int64_t from, std::int64_t until) {
  for (auto last = log.discrepancies.rbegin(); last != log.discrepancies.rend(); ++last) {
    if (last->utime > until) continue;
    if (last->utime < from) break;
    if (last->adopted != discrepancy_t::CAUSE_UNKNOWN && last->inconsistent == 0)
      return {last->adopted};
    const int count = std::clamp(last->cause_count, 0, kCauseCount);
    if (count > 0) return {last->cause, last->cause + count};
  }
  const bool is_contact =
      std::any_of(reports.begin(), reports.end(), [from, until](const DoubtReport& report) {
        return report.begin <= until && report.end >= from &&
               report.reason.find(kExternalContact) != std::string::npos;
      });
  if (is_contact) return {discrepancy_t::CAUSE_CONTACT};
  return {};
}

}  // namespace palpate::studies
