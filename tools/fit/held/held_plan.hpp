#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/control/safety_gate.hpp"
#include "tools/fit/held/held_cell.hpp"

namespace palpate::fit {

/// One motion of the hand, followed by a measurement.
struct HandMotion {
  std::string name;                                   // "z +20 mm, turn y -20 deg"
  math::Vector6d from_rest = math::Vector6d::Zero();  // of G at rest: m, rotation vector; in O
  math::Vector6d stop = math::Vector6d::Zero();  // twist in O that stops instantly there; 0: a rest
};

struct HeldPlanOptions {
  double amplitude = 0.02;               // m, along an axis
  double turn = 0.35;                    // rad, about an axis
  double speed = 0.1;                    // m/s, from which the hand stops
  double hold = 1.0;                     // s, duration of the measurement of a rest or a vibration
  double rate = 1000;                    // Hz, of the force-torque sensor
  double force_noise = 0.025;            // N, standard, of one reading
  double torque_noise = 0.001;           // N m
  double model_error = 0.01;             // of the wrench: error that averaging does not reduce
  std::vector<Eigen::Vector3d> markers;  // rest points that are observed
  double marker_noise = 1e-3;            // m, standard, of each coordinate at one rest
  double grasp_position = 1e-3;          // m, standard deviation of the prior on the grasp
  double grasp_angle = 0.01;             // rad
  std::vector<std::string> known;        // of the five that are not identified
  bool reads_wrench = true;
  int steps = 6;  // at most
};

/// Knowledge of a parameter: 95 % of the probability lies within value times or divided by `factor`
/// (if logarithmic), or within value +- half.
struct Knowledge {
  std::string name;  // young_modulus, poisson_ratio, density, mass_damping, stiffness_damping
  double value = 0;
  double deviation = 0;  // standard, of the logarithm if logarithmic
  bool is_logarithmic = true;
  bool is_determined = false;  // the deviation is below half of the prior one

  double half() const;
  double factor() const;
};

struct HeldPlanStep {
  HandMotion motion;
  double gain = 0;  // of the log determinant of information on the parameters to identify
  std::vector<Knowledge> knowledge;  // after it
};

struct HeldPlan {
  int candidates = 0;                 // considered
  std::vector<std::string> left_out;  // of them, with the reason
  std::vector<Knowledge> before;
  std::vector<HeldPlanStep> steps;
  std::vector<std::string> undetermined;  // at the end
};

/// The motions of a candidate set that jointly identify the material best: greedily, each the one
/// after which the determinant of the covariance of the parameters to identify is smallest
/// (D-optimality; Fedorov, Theory of Optimal Experiments, 1972). Information is J' J / noise^2 of
/// HeldObject at each rest and of HeldDecay after each stop, at the configuration's material;
/// priors are weak (95 %: a factor 10 of logarithmic parameters, 0.5 of Poisson's ratio), the
/// sensor's bias is unknown, as is the grasp's offset. The first motion is none: a rest as the
/// reference. The sequence ends when no motion would narrow an interval by a tenth. Candidates that
/// leave the gate's workspace, force or torque or have no equilibrium are excluded. Throws
/// std::invalid_argument.
HeldPlan plan_motions(const HeldCell& cell, const control::GateLimits& limits,
                      const HeldPlanOptions& options);

/// The candidates: rests at both ends of six axes and of pairs of a shift and a rotation, and at
/// the start; if only the hand holds the object, tilted and turned over about each axis; a stop
/// from each shift.
std::vector<HandMotion> candidate_motions(const HeldCell& cell, const HeldPlanOptions& options);

}  // namespace palpate::fit
