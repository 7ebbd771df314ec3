#include "core/estimation/consistency/explanations.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::estimation {
namespace {

constexpr int kTestsPerRecord = 2;  // of WrenchConsistency
constexpr int kRecordsPerSnapshot = 5;
/// Part of the time between two records in which all filters take the newest one.
constexpr double kPartOfPeriod = 0.25;
/// Probability that a contact has moved to any other place within a record.
constexpr double kMoves = 0.02;
/// Most evidence for or against a lasting cause before a discrepancy has begun.
constexpr double kMostAdvantage = 8;
/// Successive records are not independent: their evidence counts less.
constexpr double kIndependence = 0.5;
constexpr double kUnknownPrior = -8;  // logarithm, relative to each of the other causes
/// Probability ratio of lasting causes and the model that is reported: one false report in as many
/// runs.
constexpr double kSuspicious = 50;
constexpr int kSuspiciousRecords = 3;  // in which a sudden discrepancy would have been found
constexpr double kLarge = 0.5;         // prior deviations, of a cause that would move the shape
// An explanation is certain with this probability and misfit for so many records.
constexpr double kCertain = 0.98, kFits = 2;
constexpr int kCertainRecords = 15;

double log_sum(const std::vector<double>& logs, std::size_t begin, std::size_t end) noexcept {
  const double most = *std::max_element(logs.begin() + static_cast<std::ptrdiff_t>(begin),
                                        logs.begin() + static_cast<std::ptrdiff_t>(end));
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += std::exp(logs[i] - most);
  return most + std::log(sum);
}

}  // namespace

Explanations::Explanations(const elasticity::Body& body, const mesh::Surface& surface,
                           const WrenchKnowledge& prior)
    : responses_(body, surface), records_(kRecords), model_{CauseHypothesis(prior)} {
  const int hands = prior.states().grasps;
  if (responses_.has_clamp()) {
    for (const Cause cause : {Cause::kClampPlace, Cause::kClampCompliance})
      lasting_.push_back({CauseHypothesis(cause, 0, 0, prior)});
  }
  lasting_.push_back({CauseHypothesis(Cause::kUnevenStiffness, 0, 0, prior)});
  const auto add = [&](Cause cause, int hand, int place) {
    sudden_.push_back({CauseHypothesis(cause, hand, place, prior)});
  };
  for (int place = 0; place < responses_.place_count(); ++place) add(Cause::kContact, 0, place);
  if (!body.gravity_O.isZero(0))
    for (int place = 0; place < responses_.place_count(); ++place) add(Cause::kWeight, 0, place);
  for (const Cause cause : {Cause::kSlip, Cause::kSensorBias})
    for (int hand = 0; hand < hands; ++hand) add(cause, hand, 0);
  add(Cause::kUnknown, 0, 0);
  logs_.resize(sudden_.size());
}

void Explanations::reset() noexcept {
  newest_ = -1;
  tests_ = 0;
  finish();
}

void Explanations::finish() noexcept {
  is_active_ = is_suspected_ = false;
  needs_restart_ = true;
  count_ = certain_rounds_ = suspicious_records_ = 0;
}

void Explanations::restart(const WrenchKnowledge& knowledge) noexcept {
  started_ = newest_ + 1;
  needs_restart_ = false;
  model_.hypothesis.begin(knowledge, responses_.own_compliance(), math::Vector6d::Zero());
  for (Lasting& cause : lasting_)
    cause.hypothesis.begin(knowledge, responses_.own_compliance(), math::Vector6d::Zero());
}

void Explanations::take(const WrenchConsistency& test, const FusedState& state,
                        const elasticity::DeformationModel& model) noexcept {
  if (is_active_ && !test.is_inconsistent()) finish();
  const bool is_due = ++tests_ % kTestsPerRecord == 0;
  if (is_due || needs_restart_) responses_.update(state, model);
  if (needs_restart_) restart(test.knowledge());
  if (test.has_just_begun()) begin(test);
  if (is_due) add_record(test);
}

void Explanations::add_record(const WrenchConsistency& test) noexcept {
  const bool is_first = newest_ < started_;
  const std::array<math::Vector6d, 2> before = records_[slot(std::max(0L, newest_))].difference;
  CauseRecord& record = records_[slot(++newest_)];
  record.hands = test.record();
  record.gravity = responses_.gravity_direction();
  for (int place = 0; place < responses_.place_count(); ++place)
    record.inward[place] = responses_.inward(place);
  for (int g = 0; g < test.knowledge().states().grasps; ++g) {
    record.responses[g] = responses_.hand(g);
    record.difference[g].setZero();
    record.change[g].setZero();
    const HandRecord& hand = record.hands[g];
    if (!hand.valid) continue;
    record.difference[g] = test.knowledge().compare(hand).difference;
    if (!is_first) record.change[g] = record.difference[g] - before[g];
  }
  const auto add = [&](Lasting& cause) {
    const double sum = newest_ == started_ ? 0 : cause.sum[slot_of_sum(newest_ - 1)];
    cause.sum[slot_of_sum(newest_)] = sum + cause.hypothesis.take(record);
  };
  add(model_);
  for (Lasting& cause : lasting_) add(cause);
  weigh_lasting_causes();
}

/// Sequential probability ratio test of the model against the mixture of the lasting causes: while
/// the model holds, the ratio exceeds 1 / a with probability a at most, however long it runs (Ville
/// 1939). Causes that would move the shape little do not count, and what began suddenly is no
/// lasting cause, though some may imitate it.
void Explanations::weigh_lasting_causes() noexcept {
  const auto now = slot_of_sum(newest_);
  double ratio = 0;
  for (const Lasting& cause : lasting_) {
    if (cause.hypothesis.relative_size() < kLarge) continue;
    ratio += std::exp(kIndependence * (cause.sum[now] - model_.sum[now]) +
                      cause.hypothesis.log_possible(records_[slot(newest_)]));
  }
  ratio /= static_cast<double>(lasting_.size());
  if (is_active_) {
    is_suspected_ = is_suspected_ && ratio > 1;
    return;
  }
  suspicious_records_ = ratio > kSuspicious ? suspicious_records_ + 1 : 0;
  is_suspected_ = suspicious_records_ >= kSuspiciousRecords;
}

/// The causes that begin now start from the last knowledge that is not affected. Records since then
/// are skipped, because the discrepancy began somewhere among them.
void Explanations::begin(const WrenchConsistency& test) noexcept {
  current_ = newest_ + 1;
  const long back = test.is_suspected() ? 0
                    : test.snapshots_back() >= WrenchConsistency::kSnapshots
                        ? kSums
                        : test.snapshots_back() * kRecordsPerSnapshot;
  const long unaffected = std::max({started_ - 1, newest_ - back, newest_ - (kSums - 1)});
  next_ = 0;
  is_active_ = true;
  certain_rounds_ = count_ = 0;
  const WrenchConsistency::Discrepancy& found = test.discrepancy();
  for (Sudden& cause : sudden_) {
    cause.hypothesis.begin(test.knowledge(), responses_.own_compliance(), found.wrench);
    cause.sum = 0;
  }
  const auto sum_at = [this](const Lasting& cause, long record) {
    return record < started_ ? 0.0 : cause.sum[slot_of_sum(record)];
  };
  for (Lasting& cause : lasting_) {
    cause.before = sum_at(cause, newest_);
    cause.advantage = std::clamp(sum_at(cause, unaffected) - sum_at(model_, unaffected),
                                 -kMostAdvantage, kMostAdvantage);
  }
  log_weight_.fill(-std::log(static_cast<double>(responses_.place_count())));
  contact_evidence_ = 0;
}

void Explanations::advance(double dt) noexcept {
  const double ticks = std::max(1.0, kPartOfPeriod * kRecordPeriod / dt);
  const int most = static_cast<int>(std::ceil(static_cast<double>(sudden_.size()) / ticks));
  for (int i = 0; i < most && is_active_ && current_ <= newest_; ++i) {
    Sudden& cause = sudden_[next_];
    cause.last = cause.hypothesis.take(records_[slot(current_)]);
    cause.sum += cause.last;
    if (++next_ < sudden_.size()) continue;
    next_ = 0;
    weigh_places();
    if (current_ == newest_) rank();
    ++current_;
  }
}

/// Probabilities of the places of a contact, which may have moved since the last record.
void Explanations::weigh_places() noexcept {
  const int places = responses_.place_count();
  for (int i = 0; i < places; ++i)
    logs_[static_cast<std::size_t>(i)] = log_weight_[i] + sudden_[static_cast<std::size_t>(i)].last;
  const double total = log_sum(logs_, 0, static_cast<std::size_t>(places));
  contact_evidence_ += total;
  for (int i = 0; i < places; ++i) {
    const double weight = std::exp(logs_[static_cast<std::size_t>(i)] - total);
    log_weight_[i] = std::log((1 - kMoves) * weight + kMoves / places);
  }
}

/// Evidence of each cause: over places and hands, the mean likelihood.
void Explanations::rank() noexcept {
  const CauseRecord& record = records_[slot(newest_)];
  std::array<double, kCauses> evidence;
  std::array<const CauseHypothesis*, kCauses> best{};
  evidence.fill(-HUGE_VAL);
  for (const Lasting& cause : lasting_) {
    const auto kind = static_cast<std::size_t>(cause.hypothesis.cause());
    evidence[kind] = cause.advantage + cause.sum[slot_of_sum(newest_)] - cause.before +
                     cause.hypothesis.log_possible(record);
    best[kind] = &cause.hypothesis;
  }
  for (std::size_t begin = 0; begin < sudden_.size();) {
    const Cause cause = sudden_[begin].hypothesis.cause();
    std::size_t end = begin;
    for (; end < sudden_.size() && sudden_[end].hypothesis.cause() == cause; ++end) {
      logs_[end] = sudden_[end].hypothesis.log_possible(record);
      logs_[end] += cause == Cause::kContact ? log_weight_[end] : sudden_[end].sum;
    }
    const auto kind = static_cast<std::size_t>(cause);
    evidence[kind] = log_sum(logs_, begin, end);
    evidence[kind] +=
        cause == Cause::kContact ? contact_evidence_ : -std::log(static_cast<double>(end - begin));
    const auto most = std::max_element(logs_.begin() + static_cast<std::ptrdiff_t>(begin),
                                       logs_.begin() + static_cast<std::ptrdiff_t>(end));
    best[kind] = &sudden_[static_cast<std::size_t>(most - logs_.begin())].hypothesis;
    begin = end;
  }
  evidence[static_cast<std::size_t>(Cause::kUnknown)] += kUnknownPrior;
  const double most = *std::max_element(evidence.begin(), evidence.end());
  double sum = 0;
  for (double& value : evidence) sum += value = std::exp(kIndependence * (value - most));
  count_ = 0;
  for (int kind = 0; kind < kCauses; ++kind) {
    if (best[kind] == nullptr) continue;
    const CauseHypothesis& hypothesis = *best[kind];
    Explanation& explanation = ranked_[count_++];
    explanation = {hypothesis.cause(), evidence[kind] / sum, hypothesis.hand(),
                   Eigen::Vector3d::Zero(), math::Vector6d::Zero()};
    if (hypothesis.cause() == Cause::kUnknown) continue;
    explanation.value = hypothesis.value();
    const bool has_place =
        hypothesis.cause() == Cause::kContact || hypothesis.cause() == Cause::kWeight;
    if (has_place) explanation.location_O = responses_.location(hypothesis.place());
    if (hypothesis.cause() == Cause::kWeight) {
      const double weight = explanation.value[0];
      explanation.value.head<3>() = weight * record.gravity;
    }
  }
  std::sort(
      ranked_.begin(), ranked_.begin() + count_,
      [](const Explanation& a, const Explanation& b) { return a.probability > b.probability; });
  best_ = best[static_cast<std::size_t>(ranked_[0].cause)];
  const bool is_certain = ranked_[0].probability > kCertain && best_->misfit() < kFits;
  certain_rounds_ = is_certain && ranked_[0].cause == before_ ? certain_rounds_ + 1 : 0;
  before_ = ranked_[0].cause;
}

void Explanations::write(DiscrepancyReport& report) const noexcept {
  report.count = is_active_ ? count_ : 0;
  report.explanations = ranked_;
}

const CauseHypothesis* Explanations::certain() const noexcept {
  if (!is_active_ || certain_rounds_ < kCertainRecords) return nullptr;
  const bool can_be_absorbed =
      best_->cause() == Cause::kSlip || best_->cause() == Cause::kSensorBias;
  return can_be_absorbed ? best_ : nullptr;
}

}  // namespace palpate::estimation
