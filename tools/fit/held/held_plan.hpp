#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/control/safety_gate.hpp"
#include "tools/fit/held/held_cell.hpp"

namespace palpate::fit {

/// One thing that a hand may do for a while, and what is then read.
struct HandMotion {
  std::string name;                                   // "z +20 mm, turn y -20 deg"
  math::Vector6d from_rest = math::Vector6d::Zero();  // of G at rest: m, rotation vector; in O
  math::Vector6d stop = math::Vector6d::Zero();  // twist in O that ends there at once; 0: a rest
};

struct HeldPlanOptions {
  double amplitude = 0.02;               // m, along an axis
  double turn = 0.35;                    // rad, about an axis
  double speed = 0.1;                    // m/s, from which a stop is made
  double hold = 1.0;                     // s, that a rest or a ringing is read
  double rate = 1000;                    // Hz, of the force-torque sensor
  double force_noise = 0.025;            // N, standard, of one reading
  double torque_noise = 0.001;           // N m
  double model_error = 0.01;             // of the wrench: what no mean over readings takes away
  std::vector<Eigen::Vector3d> markers;  // rest points that something sees
  double marker_noise = 1e-3;            // m, standard, of each coordinate at one rest
  double grasp_position = 1e-3;          // m, standard, that the grasp is known by beforehand
  double grasp_angle = 0.01;             // rad
  std::vector<std::string> known;        // of the five that are not sought
  bool reads_wrench = true;
  int steps = 6;  // at most
};

/// What is known of a parameter: 95 % of the probability lies within value times or divided by
/// `factor` (where logarithmic), or within value +- half.
struct Knowledge {
  std::string name;  // young_modulus, poisson_ratio, density, mass_damping, stiffness_damping
  double value = 0;
  double deviation = 0;  // standard, of the logarithm where logarithmic
  bool is_logarithmic = true;
  bool is_determined = false;  // the deviation is below half of what it was before any motion

  double half() const;
  double factor() const;
};

struct HeldPlanStep {
  HandMotion motion;
  double gain = 0;  // of the logarithm of the determinant of information on what is sought
  std::vector<Knowledge> knowledge;  // after it
};

struct HeldPlan {
  int candidates = 0;                 // that could be thought of
  std::vector<std::string> left_out;  // of them, with the reason
  std::vector<Knowledge> before;
  std::vector<HeldPlanStep> steps;
  std::vector<std::string> undetermined;  // at the end
};

/// The motions of a candidate set that together tell the material best: greedily, each the one
/// after which the determinant of the covariance of what is sought is least (D-optimality; Fedorov,
/// Theory of Optimal Experiments, 1972). Information is J' J / noise^2 of HeldObject at each rest
/// and of HeldDecay after each stop, at the configuration's material; before it stand what anyone
/// knows (95 %: a factor 10 of logarithmic parameters, 0.5 of Poisson's ratio), the sensor's bias,
/// which is unknown, and the grasp's offset. The first motion is none: a rest that all else is
/// compared with. It ends where no motion would narrow an interval by a tenth. Candidates that
/// leave the gate's workspace, force or torque or have no equilibrium are left out. Throws
/// std::invalid_argument.
HeldPlan plan_motions(const HeldCell& cell, const control::GateLimits& limits,
                      const HeldPlanOptions& options);

/// The set: rests at both ends of six axes and of pairs of a shift and a turn, and at the start;
/// where nothing but the hand holds the object, tipped and turned over about each axis; a stop of
/// each shift.
std::vector<HandMotion> candidate_motions(const HeldCell& cell, const HeldPlanOptions& options);

}  // namespace palpate::fit
