#pragma once

#include <vector>

#include "core/estimation/consistency/cause_hypothesis.hpp"
#include "core/estimation/consistency/wrench_consistency.hpp"

namespace palpate::estimation {

/// Ranks what explains wrenches that contradict the model: one Kalman filter for each cause, hand
/// and place estimates the states of the cause along with those of the model, and the likelihood of
/// the measured wrenches is its evidence (multiple-model estimation: Bar-Shalom, Li and Kirubarajan
/// 2001, section 11.6). Causes that exist from the start (clamp, uneven stiffness) are compared
/// with the model at all times, the others from the last knowledge that is not affected on. The
/// place of a contact may change. Reference: docs/theory.md, section 4. The work is spread over
/// ticks. Nothing allocates after construction.
class Explanations {
 public:
  Explanations(const elasticity::Body& body, const mesh::Surface& surface,
               const WrenchKnowledge& prior);

  void reset() noexcept;
  /// Takes the record of the test just made. The model's sensitivity must be valid.
  void take(const WrenchConsistency& test, const FusedState& state,
            const elasticity::DeformationModel& model) noexcept;
  /// Call once per tick; `dt`: s since the last one.
  void advance(double dt) noexcept;
  /// The discrepancy has ended, or its explanation has been adopted.
  void finish() noexcept;
  /// Whether a cause that exists from the start is much more likely than the model, and large.
  bool suspects_lasting_cause() const noexcept { return is_suspected_; }
  /// Writes the ranking, or none while the wrenches are consistent.
  void write(DiscrepancyReport& report) const noexcept;
  /// A slip or bias that explains the wrenches without reasonable doubt; nullptr: none.
  const CauseHypothesis* certain() const noexcept;

 private:
  static constexpr int kRecords = 4;  // ring
  static constexpr int kSums = 41;    // ring, 4 s

  /// A cause that exists from the start, with the sums of its log-likelihoods by record.
  struct Lasting {
    CauseHypothesis hypothesis;
    std::array<double, kSums> sum{};
    double before = 0;     // sum until the discrepancy began
    double advantage = 0;  // over the model until then
  };
  /// A cause that begins with the discrepancy.
  struct Sudden {
    CauseHypothesis hypothesis;
    double last = 0;  // log-likelihood of the last record
    double sum = 0;
  };

  static std::size_t slot(long record) noexcept {
    return static_cast<std::size_t>(record % kRecords);
  }
  static std::size_t slot_of_sum(long record) noexcept {
    return static_cast<std::size_t>(record % kSums);
  }
  void restart(const WrenchKnowledge& knowledge) noexcept;
  void begin(const WrenchConsistency& test) noexcept;
  void add_record(const WrenchConsistency& test) noexcept;
  void weigh_lasting_causes() noexcept;
  void rank() noexcept;
  void weigh_places() noexcept;

  CauseResponses responses_;
  std::vector<CauseRecord> records_;
  long newest_ = -1;      // index of the last record
  long started_ = 0;      // index of the first record of the lasting causes
  long current_ = 0;      // record that the sudden causes are at
  std::size_t next_ = 0;  // of the sudden causes
  int tests_ = 0;
  Lasting model_;  // no cause at all
  std::vector<Lasting> lasting_;
  std::vector<Sudden> sudden_;                                // contacts first
  std::array<double, CauseResponses::kPlaces> log_weight_{};  // of the places of a contact
  double contact_evidence_ = 0;
  bool is_suspected_ = false;  // a lasting cause
  int suspicious_records_ = 0;
  bool is_active_ = false;     // during a discrepancy
  bool needs_restart_ = true;  // of the lasting causes, whose states hold a discrepancy, or nothing
  int count_ = 0;
  std::array<Explanation, kCauses> ranked_{};
  const CauseHypothesis* best_ = nullptr;
  Cause before_ = Cause::kUnknown;  // best of the ranking before
  int certain_rounds_ = 0;
  std::vector<double> logs_;  // by sudden cause
};

}  // namespace palpate::estimation
