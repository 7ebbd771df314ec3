#pragma once

#include <vector>

#include "core/collision/obstacle.hpp"
#include "core/mesh/point_locator.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::collision {

/// Greatest distance, m, of samples with which a flat face sinks into the obstacle by less than
/// 0.4 % of its smallest radius; infinite for a half-space.
double sample_spacing(const Obstacle& obstacle) noexcept;

/// Material points of a deformable surface that may not enter an obstacle: its nodes and, on each
/// face, points of a triangular lattice at most `spacing` apart at rest (but at most 24 to an
/// edge). A quadratic face gets at least its centre: with all nodes on a plane it can still sink
/// in, at its centre by a third of the height of its corners. `rest`: 3 x n, m. The weights are the
/// shape functions of the face; each point occurs once.
std::vector<mesh::PointWeights> surface_samples(const mesh::Surface& surface,
                                                const Eigen::Matrix3Xd& rest, double spacing);

}  // namespace palpate::collision
