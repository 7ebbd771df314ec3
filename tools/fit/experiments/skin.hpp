#pragma once

#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Kind `membrane`: skin stretched by two pads stuck to it, of which one moves along -x, with the
/// field of displacements between them and the force of the moving pad. Plane-stress finite
/// elements at large strain of an exponentially stiffening sheet on an elastic foundation
/// (core/solid/solid_membrane.hpp), driven by nothing but the pads' motion.
///
/// Columns: `frame`, `point`, `x`, `y` (current position; the least frame is the reference). Keys:
/// pads {file, columns: frame, moving_x|y (displacement), fixed_x|y (position of its inner edge's
/// middle), force}; geometry {pad_width, pad_length, margin, cell}: the moving pad's inner edge
/// begins at x = 0, pads reach away from each other from their inner edges, and the skin is at rest
/// a margin around them; frames {fitted, predicted}, lists; every (1): each which point is used;
/// deviations {field (m), force (N)}.
/// Parameters: shear_thickness (N/m: shear modulus times thickness, which is all that can be told),
/// fung_exponent, fibre_thickness (N/m), fibre_angle (rad, from x towards y), foundation (N/m^3)
/// and foundation_grip (m). The mean of the field's y components is left out of what is fitted,
/// frame by frame: limbs drift. Findings: RMSE (m) of the field over the predicted frames, beside
/// that of linear scaling of the last fitted frame: of the model alone, and of that frame carried
/// on by what the model says of the departure from proportion.
std::unique_ptr<Experiment> make_membrane(const config::Node& node,
                                          const std::filesystem::path& folder);

}  // namespace palpate::fit
