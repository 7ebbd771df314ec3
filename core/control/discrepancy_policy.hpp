#pragma once

namespace palpate::control {

/// What the controller does while the wrenches contradict the model.
enum class DiscrepancyAction { kContinue, kSlow, kStop };

/// Factor on the commanded motion while the wrenches contradict the model. It changes linearly, so
/// that the hand neither jerks when a discrepancy begins nor when it has ended. The direction of
/// the motion is unchanged, and the gates follow.
class DiscrepancyPolicy {
 public:
  struct Options {
    DiscrepancyAction action = DiscrepancyAction::kSlow;
    double speed = 0.25;  // of kSlow: fraction of the commanded motion, in [0, 1]
  };
  /// s, from full speed to rest. A hand at the gate's default speeds then keeps the gate's default
  /// accelerations: 0.1 m/s and 0.5 rad/s end at 0.4 m/s^2 and 2 rad/s^2.
  static constexpr double kRampTime = 0.25;

  DiscrepancyPolicy() : DiscrepancyPolicy(Options()) {}
  /// Throws std::invalid_argument if the speed is out of range.
  explicit DiscrepancyPolicy(const Options& options);

  const Options& options() const noexcept { return options_; }
  /// Called once per tick. `dt`: s; one that is not positive and finite changes nothing.
  void update(bool in_doubt, double dt) noexcept;
  /// In [0, 1]; exactly 1 while there is no discrepancy, and exactly the speed once it is reached.
  double factor() const noexcept { return factor_; }
  void reset() noexcept { factor_ = 1; }
  /// Continues from the factor of the policy that this one replaces.
  void take_over(const DiscrepancyPolicy& last) noexcept { factor_ = last.factor_; }

 private:
  Options options_;
  double goal_ = 1;  // factor during a discrepancy
  double factor_ = 1;
};

}  // namespace palpate::control
