#pragma once

#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Kind `membrane`: skin stretched by two pads attached to it, one of which moves along -x, with
/// the displacement field between them and the force of the moving pad. Plane-stress finite
/// elements at large strain of an exponentially stiffening sheet on an elastic foundation
/// (core/solid/solid_membrane.hpp), driven only by the pads' motion.
///
/// Columns: `frame`, `point`, `x`, `y` (current position; the lowest frame is the reference). Keys:
/// pads {file, columns: frame, moving_x|y (displacement), fixed_x|y (position of its inner edge's
/// middle), force}; geometry {pad_width, pad_length, margin, cell}: the moving pad's inner edge
/// begins at x = 0, the pads extend away from each other from their inner edges, and the skin is at
/// rest a margin around them; frames {fitted, predicted}, lists; every (1): stride of the points
/// used; deviations {field (m), force (N)}. Parameters: shear_thickness (N/m: shear modulus times
/// thickness, which are not separable), fung_exponent, fibre_thickness (N/m), fibre_angle (rad,
/// from x towards y), foundation (N/m^3) and foundation_grip (m). The mean of the field's y
/// components is excluded from the fit, frame by frame, since limbs drift. Findings: RMSE (m) of
/// the field over the predicted frames, compared with linear scaling of the last fitted frame: of
/// the model alone, and of that frame corrected by the model's deviation from proportionality.
std::unique_ptr<Experiment> make_membrane(const config::Node& node,
                                          const std::filesystem::path& folder);

}  // namespace palpate::fit
