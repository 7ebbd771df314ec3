#include "core/estimation/contact_detector.hpp"

namespace palpate::estimation {
namespace {

// Quantiles of the chi-square distribution with the 6 degrees of freedom of a hand.
constexpr double kChiSquare6At6e3 = 18;  // p = 6.2e-3: one of 160 changes by noise alone
constexpr double kChiSquare6At9e5 = 28;  // p = 9.4e-5: one of 10,000

constexpr double kWary = 8;       // factor on the thresholds just after a contact has ended
constexpr double kWaryFor = 0.3;  // s, time constant with which it decays to 1
/// Squared standard deviations below which a force is not significant: 3 sigma.
constexpr double kSignificant = 3 * 3;
constexpr double kFadesIn = 0.3;  // s for which a contact may be weak, or not explain the wrenches

}  // namespace

void ContactDetector::reset() noexcept {
  state_ = State::kNone;
  unexplained_count_ = sudden_count_ = 0;
  weak_time_ = unexplained_contact_time_ = 0;
  confirmations_ = 0;
  since_contact_ = kLongAgo;
}

void ContactDetector::clear() noexcept {
  unexplained_count_ = sudden_count_ = 0;
  if (!has_contact()) state_ = State::kNone;
}

void ContactDetector::judge_change(double latest, double mean, double rows) noexcept {
  const double wary = 1 + kWary * std::exp(-since_contact_ / kWaryFor);
  // The second consecutive change must be rarer by noise than the first.
  const double enough = sudden_count_ == 0 ? kChiSquare6At6e3 : kChiSquare6At9e5;
  const bool sudden = latest > wary * enough / kHandRows * rows;
  const bool lasting = mean > wary * sampling_.gate / kHandRows * rows;
  sudden_count_ = sudden ? sudden_count_ + 1 : 0;
  unexplained_count_ = sudden || lasting ? unexplained_count_ + 1 : 0;
  state_ = unexplained_count_ > 0 ? State::kSuspected : State::kNone;
}

bool ContactDetector::wants_search() const noexcept {
  return sudden_count_ >= kConsecutive || unexplained_count_ >= options_.suspect_count;
}

void ContactDetector::judge_contact(double test, double rows, bool is_below_noise,
                                    bool is_as_before) noexcept {
  is_below_noise_ = is_below_noise;
  if (test <= sampling_.gate / kHandRows * rows) {
    unexplained_count_ = 0;
    state_ = State::kTracking;
    if (!is_below_noise) ++confirmations_;
    return;
  }
  ++unexplained_count_;
  state_ =
      unexplained_count_ >= kConsecutive && is_as_before ? State::kReleased : State::kUnexplained;
  if (wants_new_location()) confirmations_ = kConsecutive;  // whatever it is, it lasts
}

void ContactDetector::begin() noexcept {
  state_ = State::kTracking;
  unexplained_count_ = sudden_count_ = 0;
  weak_time_ = 0;
  is_below_noise_ = false;
}

void ContactDetector::end() noexcept {
  state_ = State::kNone;
  unexplained_count_ = sudden_count_ = 0;
  unexplained_contact_time_ = 0;
  confirmations_ = 0;
  since_contact_ = 0;
}

bool ContactDetector::advance(double dt, double significance, bool has_baseline) noexcept {
  since_contact_ += dt;
  if (!has_contact()) return false;
  // While the force is not being estimated, its covariance is meaningless.
  const bool unsure = unexplained_count_ == 0 && significance < kSignificant;
  weak_time_ = is_below_noise_ || unsure ? weak_time_ + dt : 0;
  unexplained_contact_time_ = unexplained_count_ > 0 ? unexplained_contact_time_ + dt : 0;
  return weak_time_ >= kFadesIn || unexplained_contact_time_ >= kFadesIn ||
         state_ == State::kReleased || !has_baseline;
}

}  // namespace palpate::estimation
