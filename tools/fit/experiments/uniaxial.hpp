#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// A stress over time and its derivatives by parameters (one column each).
struct StressHistory {
  Eigen::VectorXd stress;
  Eigen::MatrixXd by_parameter;
};

/// Stress of a Maxwell branch in parallel with a spring, i.e. the standard linear solid: q' = g P'
/// - q / tau, exact for a P that is linear between samples (Simo and Hughes 1998, section 10.3). At
/// the first sample q is 0. The columns of g and tau are added to.
StressHistory relaxing_part(const StressHistory& elastic, const Eigen::VectorXd& time, double ratio,
                            double relaxation_time, Eigen::Index ratio_column,
                            Eigen::Index time_column);

/// Kind `uniaxial`: a bar pulled or pressed along its axis, with free sides.
///
/// Columns: `force` or `stress` (nominal); `displacement`, `gap`, `strain` or `stretch`; if
/// recorded `time` and `width` (transverse). Force and displacement are positive along `direction`.
/// Keys:
///   model            a material of core/solid/strain_energy.hpp
///   direction        tension | compression
///   geometry         length (of `gap`: default its first value); area, or diameter, or width
///                    and thickness; lengths at rest, SI or with a unit ("10.65 mm")
///   poisson_ratio    known (0.5, constant volume); `free` needs a width; `by_width`: free
///                    if a width is recorded, otherwise 0
///   contact_offset   free | none: displacement at first contact of the plate; compression
///   clamp_offset     free | none: displacement at which the bar is taut; tension
///   load_bias        free | none: reading of the load cell without load
///   viscosity        free | none: Kelvin-Voigt, eta d(stretch)/dt added to the nominal stress
///   relaxation       free | none: a standard linear solid; the fraction `relaxation_ratio` of
///                    elastic stress changes is added and decays with `relaxation_time`
///   window           {from, to}, s: time range of the rows to read
///   every            4: every fourth row only, after the video is aligned
///   cycles           {skip: 1, average: true, zero: true, points: 101}
///   video            a recording whose clock is aligned (video.hpp)
///   use, held_out    selections (recording.hpp) by `strain`, `load`, `sample` or a column
///   deviation, width_deviation   of a sample; default: 1 % of the range, 0.1 % of the width
///
/// Force = area (P(stretch) + overstress) + bias, with stretch = 1 +- (u - offset) / length.
/// Parameters: the material's constants, `viscosity` (Pa s), `relaxation_ratio`, `relaxation_time`
/// (s); own: contact_offset or clamp_offset (m; of strain if strain was recorded), load_bias,
/// rest_width (m, if width is recorded).
std::unique_ptr<Experiment> make_uniaxial(const config::Node& node,
                                          const std::filesystem::path& folder);

}  // namespace palpate::fit
