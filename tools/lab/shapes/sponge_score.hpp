#pragma once

#include "tools/lab/shapes/pushed_sponge.hpp"
#include "tools/lab/shapes/shape_score.hpp"

namespace palpate::shapes {

/// Fits modulus times thickness, Poisson's ratio and the height of the first contact to the frames
/// of the loading branch to 20 % depth, and scores outline and force from 20 to 40 %.
ShapeResult score_pushed_sponge(const PushedSponge& sponge);

}  // namespace palpate::shapes
