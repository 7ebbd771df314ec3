#pragma once

#include <array>

#include "core/contact/approach_record.hpp"
#include "core/contact/indentation_fit.hpp"
#include "core/control/control_law.hpp"

namespace palpate::control {

/// Request for a guarded motion. Speed, distance and retreat of 0: as configured.
struct TouchRequest {
  Eigen::Vector3d direction_W = Eigen::Vector3d::Zero();  // of the motion; any positive length
  double force = 0;                                       // N, against the motion, that ends it
  double speed = 0;                                       // m/s, of the approach
  double distance = 0;  // m, after which the approach ends without contact
  double retreat = 0;   // m, to back off from the touched point
};

enum class TouchState {
  kIdle,  // nothing has been requested
  kWaiting,
  kApproaching,
  kRetreating,
  kTouched,
  kNoContact,
  kStopped
};

/// State of the last requested motion; its result once it has ended.
struct TouchReport {
  TouchState state = TouchState::kIdle;
  double travel = 0;  // m, along the direction
  double force = 0;   // N, against the motion, smoothed; after the end the largest one
  /// Centre of the tip at zero force, and the point of the tip ahead of it, in W, m; of kTouched.
  Eigen::Vector3d centre_W = Eigen::Vector3d::Zero(), point_W = Eigen::Vector3d::Zero();
  double point_deviation = -1;      // m, standard deviation along the direction; negative: none
  double indentation = -1;          // m, at the largest force; negative: none
  double stiffness = -1;            // N/m, force over indentation there; negative: none
  double stiffness_deviation = -1;  // N/m; negative: none
  std::array<char, 128> reason{};   // of kStopped and kNoContact, and of a result without deviation
};

/// Moves the hand along a direction until the force against the motion reaches a threshold, backs
/// off, and finds from the recorded approach where the tip met the surface at zero force
/// (contact::IndentationFit). Moves on request only, by translation; needs neither feature, target
/// nor model.
///
/// Sequence: at rest, the mean force becomes zero force (tare); approach at constant speed; braking
/// and a rest, during which the fit is computed; retreat along the same line, never beyond its
/// start, because only the travelled line is known to be free. Without contact the hand stays at
/// the end of the line.
///
/// The tip must not touch anything at the start, and the surface should face the motion: of a ball
/// of radius R on a surface inclined by an angle a the reported point lies R (1 / cos a - 1) before
/// the surface along the direction. The centre is right for any inclination.
class GuardedMotion : public ControlLaw {
 public:
  struct Options {
    double speed = 0.005;                             // m/s
    double distance = 0.05;                           // m
    double retreat = 0.01;                            // m
    double acceleration = 0.05;                       // m/s^2
    Eigen::Vector3d tip_G = Eigen::Vector3d::Zero();  // m, centre of the tip in G
    double tip_radius = 0.004;                        // m; 0: a point
    double baseline_time = 0.5;                       // s, of the mean force at rest
    double hold_time = 0.1;                           // s, rest before the retreat, at least
    double force_smoothing = 0.02;                    // s, of the force for the threshold
    double force_limit = 3;                           // N, largest threshold; above it the hand
                                                      // backs off at once
    double force_delay = 0;                           // s, of the force against the pose
    contact::IndentationFit::Options fit;
  };

  /// What the law reads in a cycle.
  struct Inputs {
    double dt = 1e-3;  // s
    /// Pose and force are current, and the robot may move; else why not.
    bool is_usable = false;
    const char* reason = "";
    math::Pose X_WG = math::Pose::Identity();
    Eigen::Vector3d force_W = Eigen::Vector3d::Zero();  // N, of the hand on the object
    bool is_rejected = false;                           // by the gate, in the last cycle
    const char* gate_reason = "";                       // what the gate limited in the last cycle
  };

  /// `speed_limit`: m/s, of the gate. Throws std::invalid_argument naming the option and its range.
  GuardedMotion(const Options& options, double speed_limit);

  /// Begins a motion; returns "" or why it is refused: one is running, or a value is out of range.
  const char* begin(const TouchRequest& request) noexcept;
  /// Ends the motion; the command is zero from now on.
  void stop(const char* reason) noexcept;
  bool is_running() const noexcept { return phase_ != Phase::kRest; }
  const TouchReport& report() const noexcept { return report_; }

  /// Velocity of the hand in W, m/s; its rotation does not change.
  Eigen::Vector3d advance(const Inputs& inputs) noexcept;

  void configure_for(const shape::Feature&) override {}
  /// Zero: the law follows no target.
  void compute(const LawInputs& inputs, LawOutput& output) noexcept override;
  void reset() noexcept override { stop("reset"); }

 private:
  enum class Phase { kRest, kBaseline, kApproach, kBrake, kRetreat };
  /// Along the line, m, N, as of this cycle.
  struct Sample {
    Eigen::Vector3d tip_W;
    double travel = 0, force = 0;
  };

  void enter(Phase phase) noexcept;
  Sample measure(const Inputs& inputs) const noexcept;
  void baseline(const Inputs& inputs) noexcept;
  void approach(const Inputs& inputs, const Sample& sample) noexcept;
  void brake(const Inputs& inputs, const Sample& sample) noexcept;
  void retreat(const Inputs& inputs, const Sample& sample) noexcept;
  void give_way(const Sample& sample) noexcept;
  void change_speed(double wanted, double dt) noexcept;
  double speed_towards(double left, double dt) const noexcept;
  bool follows(const Inputs& inputs, const Sample& sample) noexcept;
  void conclude() noexcept;
  void finish(TouchState state, const char* reason) noexcept;
  void put_reason(const char* reason) noexcept;

  Options options_;
  double speed_limit_;
  TouchRequest request_;  // values in force
  Phase phase_ = Phase::kRest;
  TouchReport report_;
  double time_ = 0;   // s, in the phase
  double speed_ = 0;  // m/s, along the direction, commanded
  Eigen::Vector3d start_W_ = Eigen::Vector3d::Zero();
  double force_sum_ = 0;  // N, of the baseline
  int force_count_ = 0;
  double smoothed_ = 0, largest_ = 0;  // N
  bool is_armed_ = false;              // the threshold applies: the hand moves at constant speed
  Sample contact_;                     // where the threshold was reached
  double goal_ = 0;                    // m, travel at which the retreat ends
  bool gives_way_ = false;             // the force was above its limit
  double watched_travel_ = 0, watched_way_ = 0, watched_time_ = 0;  // m, m, s
  contact::ApproachRecord record_;
  contact::IndentationFit fit_;
};

}  // namespace palpate::control
