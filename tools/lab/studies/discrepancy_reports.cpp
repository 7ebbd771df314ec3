#include "tools/lab/studies/discrepancy_reports.hpp"

#include <algorithm>

#include "tools/lab/scores/belief_score.hpp"

namespace palpate::studies {
namespace {

constexpr std::int64_t kContactAge = 100000;   // us, of an UNKNOWN_CONTACT that no end followed
constexpr std::int64_t kHealthAfter = 200000;  // us; HEALTH follows ten times a second

/// Parts of the reasons of failing inputs and solvers (core/estimation, core/sensing, rt).
constexpr const char* kFailures[] = {"pose of the hand",
                                     "hand's pose",
                                     "time step",
                                     "deformation model",
                                     "contact load",
                                     "no fresh wrench",
                                     "not finite",
                                     "reading",
                                     "taring",
                                     "the loop runs late",
                                     "no stiffness of the grasp yet",
                                     "fallback"};

void add_reason(const std::string& reason, std::string& to) {
  if (reason.empty() || to.find(reason) != std::string::npos) return;
  if (!to.empty()) to += "; ";
  to += reason;
}

/// What a log reports at one instant after the other.
class Doubts {
 public:
  explicit Doubts(const log::RunLog& log) : log_(log) {}

  /// Whether one holds at the time of an estimate; its reasons are appended.
  bool hold(const estimate_t& estimate, std::string& reasons) {
    bool holds = false;
    if (estimate.status == estimate_t::STATUS_DEGRADED) {
      const std::string reason = health_reason(estimate.utime);
      holds = is_doubt(reason);
      if (holds) add_reason(reason, reasons);
    }
    if (scores::reports_contact(estimate) || detects_contact(estimate.utime)) {
      holds = true;
      add_reason(kExternalContact, reasons);
    }
    const discrepancy_t* discrepancy = log::latest(log_.discrepancies, estimate.utime);
    if (discrepancy != nullptr && discrepancy->inconsistent != 0) {
      holds = true;
      // ESTIMATE is degraded as well, with a reason, unless an explanation has been adopted.
      if (reasons.empty()) add_reason("inconsistent wrenches", reasons);
    }
    return holds;
  }

 private:
  bool detects_contact(std::int64_t utime) const {
    const unknown_contact_t* contact = log::latest(log_.unknown_contacts, utime);
    return contact != nullptr && contact->force_deviation >= 0 &&
           utime - contact->utime <= kContactAge;
  }

  /// Of the first HEALTH after that time; empty if it is not degraded.
  std::string health_reason(std::int64_t utime) {
    while (health_ < log_.health.size() && log_.health[health_].utime < utime) ++health_;
    if (health_ == log_.health.size()) return "";
    const health_t& health = log_.health[health_];
    if (health.state != health_t::STATE_DEGRADED || health.utime > utime + kHealthAfter) return "";
    return reinterpret_cast<const char*>(health.reason);
  }

  const log::RunLog& log_;
  std::size_t health_ = 0;
};

}  // namespace

bool is_doubt(const std::string& reason) {
  return std::none_of(std::begin(kFailures), std::end(kFailures), [&reason](const char* failure) {
    return reason.find(failure) != std::string::npos;
  });
}

std::vector<DoubtReport> doubt_reports(const log::RunLog& log, std::int64_t from) {
  std::vector<DoubtReport> reports;
  Doubts doubts(log);
  bool is_open = false;
  for (const estimate_t& estimate : log.estimates) {
    if (estimate.utime < from) continue;
    std::string reasons = is_open ? reports.back().reason : "";
    const bool holds = doubts.hold(estimate, reasons);
    if (holds && !is_open) reports.push_back({estimate.utime, estimate.utime, ""});
    if (holds) {
      reports.back().end = estimate.utime;
      reports.back().reason = reasons;
    }
    is_open = holds;
  }
  return reports;
}

const DoubtReport* reported_at(const std::vector<DoubtReport>& reports, std::int64_t from) {
  const auto found = std::find_if(reports.begin(), reports.end(),
                                  [from](const DoubtReport& report) { return report.end >= from; });
  return found == reports.end() ? nullptr : &*found;
}

bool is_reported(const std::vector<DoubtReport>& reports, std::int64_t utime) {
  return std::any_of(reports.begin(), reports.end(), [utime](const DoubtReport& report) {
    return report.begin <= utime && utime <= report.end;
  });
}

}  // namespace palpate::studies
