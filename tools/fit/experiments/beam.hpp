#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// A damped free oscillation.
struct Swing {
  double period = 0;     // s
  double decay = 0;      // 1/s: amplitudes decay by exp(-decay t)
  int half_periods = 0;  // from which both were computed
};

/// Of values about `rest` at ascending times: the period from the mean interval between crossings
/// of the rest value, the decay by a straight line through the logarithms of the largest deviations
/// between them, as far as they exceed `least`. Zeros if there are fewer than three half periods.
Swing measure_swing(const Eigen::VectorXd& times, const Eigen::VectorXd& values, double rest,
                    double least);

/// Kind `beam`: a clamped beam is held straight and released, sags under its weight and one at its
/// tip, and oscillates until rest. Quadratic finite elements of a Neo-Hookean solid (BeamModel).
///
/// Columns: `time` and, for each marker, `<marker>_x|y|z` in the beam's frame (x along it, z up).
/// Keys: geometry {corner [m], size [m], cells}, with at least two cells across (one is a tenth too
/// compliant in bending); `corner` has the smallest coordinates, the clamp is there; tip_load (N,
/// 0), distributed along the upper edge of the tip, whose mass takes part in the oscillation;
/// markers, a list of {name, at: [m]}, perpendicular on stalks off the surface; clamp_markers
/// likewise, on the clamp; held_until (s, 0), rest_from (s): rest displacements are the difference
/// of the mean poses before and after these; swing {from, to, step} (s): the fitted part of the
/// oscillation and the step of its integration; density, poisson_ratio {start, from, to}; clamp:
/// rigid | free (whether it may tilt and shift under load); deviations {rest, swing} (m).
/// Parameters: young_modulus, poisson_ratio, density (known), mass_damping, stiffness_damping
/// (Rayleigh, shared), NAME.clamp_tilt_x|y|z, NAME.clamp_offset_x|y|z, NAME.release (s),
/// NAME.held_sag (initial sag while held: a hand releases neither instantly nor a perfectly
/// straight beam). Findings: tip error at rest, period, decay.
std::unique_ptr<Experiment> make_beam(const config::Node& node,
                                      const std::filesystem::path& folder);

}  // namespace palpate::fit
