#pragma once

#include <Eigen/Core>

namespace palpate::scores {

/// Agreement of two clouds by an octree, as in thesis Figs 4.9 to 4.11: the octree's cubes that
/// hold a point of one cloud are occupied, and the score is the fraction of the other cloud's
/// points that fall into occupied cubes. It depends on the resolution, which is therefore part of
/// it: planes along the cubes that lie half a cube apart agree by half on average, oblique ones by
/// more. The thesis' own resolution and formula are not known.
struct OctreeAgreement {
  double resolution = 0;         // m, side of a cube
  double estimate_in_truth = 0;  // fraction of the estimate's points in cubes of the truth
  double truth_in_estimate = 0;  // fraction of the truth's points in cubes of the estimate
  int estimate_cubes = 0;
  int truth_cubes = 0;
  int shared_cubes = 0;
};

/// Clouds 3 x n in one frame, m, each with spacing well below `resolution`. Throws
/// std::invalid_argument if a cloud is empty, not finite or too large for an octree of 2^16 cubes a
/// side, or the resolution is not positive.
OctreeAgreement octree_agreement(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth,
                                 double resolution);

}  // namespace palpate::scores
