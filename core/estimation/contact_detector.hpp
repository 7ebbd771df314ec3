#pragma once

#include "core/estimation/wrench_innovation.hpp"

namespace palpate::estimation {

/// Decides from the test values of successive wrench updates of resting hands whether there is an
/// unmodelled external contact. It contains no wrenches and no geometry: ContactTracker computes
/// the test values and carries out the decisions.
///
/// | state        | condition                                   | next         | action        |
/// |--------------|---------------------------------------------|--------------|---------------|
/// | kNone        | a change of the wrenches beyond the noise   | kSuspected   | collect       |
/// | kSuspected   | no change beyond the noise                  | kNone        | discard       |
/// |              | two sudden changes, or suspect_count in all | kSuspected   | search        |
/// |              | a location explains the change: begin()     | kTracking    | load model    |
/// |              | no explanation for 2 s                      | kSuspected   | new baseline  |
/// | kTracking    | the contact explains the wrenches           | kTracking    | correct force |
/// |              | it does not                                 | kUnexplained | collect       |
/// | kUnexplained | it does again                               | kTracking    | correct force |
/// |              | two consecutive updates unexplained         | kUnexplained | search        |
/// |              | and the wrenches are as before the contact  | kReleased    |               |
/// |              | another location explains them: begin()     | kTracking    | load model    |
/// |              | for 0.3 s                                   | kNone        | drop contact  |
/// | with contact | two updates that it explains, its force     |              |               |
/// |              | beyond the noise, or two unexplained ones   |              | report it     |
/// |              | force within the noise for 0.3 s            | kNone        | drop contact  |
/// | kReleased    | end of the tick                             | kNone        | drop contact  |
/// | any          | a hand moves, or the baseline is lost       | kNone        | drop contact  |
///
/// Changes just after a contact has ended count less, because the object oscillates and the pads
/// relax. What noise imitates in one update ends with the next ones: a contact is reported once
/// they confirm it, while the shape follows it from its begin on.
class ContactDetector {
 public:
  enum class State {
    kNone,         // no external contact
    kSuspected,    // none yet, but the wrenches have changed by more than their noise
    kTracking,     // an external contact explains the wrenches
    kUnexplained,  // there is one, but it has moved, grown or ended: it does not explain them
    kReleased,     // the contact has ended, because the wrenches are as before
  };
  struct Options {
    /// Consecutive changes beyond the noise before an external contact is searched for.
    int suspect_count = 3;
  };

  ContactDetector(const WrenchSampling& sampling, const Options& options)
      : sampling_(sampling), options_(options) {}

  State state() const noexcept { return state_; }
  bool has_contact() const noexcept {
    return state_ != State::kNone && state_ != State::kSuspected;
  }
  /// Consecutive updates that were not explained, and their duration, s.
  int unexplained_count() const noexcept { return unexplained_count_; }
  double unexplained_time() const noexcept { return unexplained_count_ * sampling_.period; }
  /// Whether nothing has explained the wrenches for too long, so that a new baseline is due.
  bool needs_baseline() const noexcept { return unexplained_time() > kPatience; }
  /// Half of that time, after which the user should know.
  bool is_overdue() const noexcept { return unexplained_time() > kPatience / 2; }
  /// Whether updates have confirmed the contact since it began, so that it may be reported.
  bool is_confirmed() const noexcept { return has_contact() && confirmations_ >= kConsecutive; }
  /// Whether the force of the contact is at present not significant.
  bool is_weak() const noexcept { return weak_time_ > 0; }

  void reset() noexcept;
  /// Discards suspicions. Not with a contact, which end() ends.
  void clear() noexcept;

  /// Judges an update without contact. `latest`, `mean`: normalised squares of the change of the
  /// last wrenches and of their short-term mean; `rows`: their degrees of freedom. Negative values:
  /// not available.
  void judge_change(double latest, double mean, double rows) noexcept;
  /// Whether the suspicion justifies a search.
  bool wants_search() const noexcept;

  /// Judges an update with a contact. `test`: normalised square of the change that the contact does
  /// not explain. `is_below_noise`: the wrenches caused by the contact are. `is_as_before`: the
  /// wrenches are as they were before it.
  void judge_contact(double test, double rows, bool is_below_noise, bool is_as_before) noexcept;
  /// Whether the change persists, so that another location should be searched for.
  bool wants_new_location() const noexcept {
    return state_ == State::kUnexplained && unexplained_count_ >= kConsecutive;
  }

  /// The contact begins, or continues at another location.
  void begin() noexcept;
  void end() noexcept;
  /// Call once per tick. `significance`: squared force of the contact over its covariance. True if
  /// the contact must be dropped: no estimate is better than a wrong one.
  bool advance(double dt, double significance, bool has_baseline) noexcept;

 private:
  static constexpr double kPatience = 2;   // s, maximum duration of an unexplained change
  static constexpr double kLongAgo = 1e3;  // s
  /// Consecutive sudden changes, and updates that confirm a contact: with the thresholds of both of
  /// them no false alarm within hours.
  static constexpr int kConsecutive = 2;

  WrenchSampling sampling_;
  Options options_;
  State state_ = State::kNone;
  int unexplained_count_ = 0;
  int sudden_count_ = 0;                 // consecutive changes far beyond the noise
  int confirmations_ = 0;                // updates since the contact began that confirm it
  bool is_below_noise_ = false;          // the contact's contribution to the wrenches is
  double since_contact_ = kLongAgo;      // s since the last contact ended
  double weak_time_ = 0;                 // s for which the contact's force has not been significant
  double unexplained_contact_time_ = 0;  // s for which the contact has not explained the wrenches
};

}  // namespace palpate::estimation
