#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/lab/shapes/beam_model.hpp"
#include "tools/lab/shapes/shape_score.hpp"

namespace palpate::shapes {

/// Scores of one prediction. `is_fitted`: the modulus was fitted to the block's drop. The picture's
/// quantities are compared as they were measured, through the camera.
std::vector<ShapeScore> compare_beam(const HangingBeams& beams, const BeamCase& recorded,
                                     const BeamModel& model, const Eigen::Matrix3Xd& positions,
                                     bool is_fitted);

/// Predicts every case. A beam of one material: the modulus is fitted to the drop of its block
/// alone, and everything else follows; if other beams are of the same material, it is predicted
/// from their moduli, too. A beam of two materials is predicted from the moduli of beams of each.
/// `given`: moduli (Pa) by material that replace a fit. Each case is repeated with the hyperelastic
/// model, unless it has two materials.
std::vector<ShapeResult> score_hanging_beams(const std::vector<HangingBeams>& recordings,
                                             const std::map<std::string, double>& given);

}  // namespace palpate::shapes
