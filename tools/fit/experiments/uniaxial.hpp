#pragma once

#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Kind `uniaxial`: a bar pulled or pressed along its axis, its sides free.
///
/// Columns: `force` or `stress` (nominal); `displacement`, `gap`, `strain` or `stretch`; where
/// recorded `time` and `width` (across). Force and displacement are positive along `direction`.
/// Keys:
///   model            a material of core/solid/strain_energy.hpp
///   direction        tension | compression
///   geometry         length (of `gap`: its first value where absent); area, or diameter, or width
///                    and thickness; lengths at rest, SI or with a unit ("10.65 mm")
///   poisson_ratio    known (0.5, which keeps the volume); `free` needs a width; `by_width`: free
///                    where a width is recorded, else 0
///   contact_offset   free | none: displacement at which the plate touches; compression
///   clamp_offset     free | none: displacement at which the bar is taut; tension
///   load_bias        free | none: what the load cell shows without load
///   viscosity        free | none: Kelvin-Voigt, eta d(stretch)/dt beside the nominal stress
///   relaxation       free | none: a standard linear solid; a part `relaxation_ratio` of the
///                    elastic stress' changes is added and fades with `relaxation_time`
///   window           {from, to}, s: rows to read at all
///   every            4: every fourth row alone, after the video is aligned
///   cycles           {skip: 1, average: true, zero: true, points: 101}
///   video            a recording whose clock is aligned (video.hpp)
///   use, held_out    selections (recording.hpp) by `strain`, `load`, `sample` or a column
///   deviation, width_deviation   of a sample; absent: 1 % of the range, 0.1 % of the width
///
/// Force = area (P(stretch) + overstress) + bias, with stretch = 1 +- (u - offset) / length.
/// Parameters: the material's constants, `viscosity` (Pa s), `relaxation_ratio`, `relaxation_time`
/// (s); own: contact_offset or clamp_offset (m; of strain where strain was recorded), load_bias,
/// rest_width (m, where width is recorded).
std::unique_ptr<Experiment> make_uniaxial(const config::Node& node,
                                          const std::filesystem::path& folder);

}  // namespace palpate::fit
