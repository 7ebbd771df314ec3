#include "tools/lab/scores/octree_score.hpp"

#include <octomap/OcTree.h>

#include <stdexcept>

namespace palpate::scores {
namespace {

/// Offset of the cubes' borders as a fraction of their side: away from where planar faces of
/// objects tend to lie, since there rounding would decide which cube a point is in.
constexpr double kGridShift = 0.382;

octomap::OcTreeKey key_of(const octomap::OcTree& tree, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = point.array() + kGridShift * tree.getResolution();
  octomap::OcTreeKey key;
  if (!p.allFinite() || !tree.coordToKeyChecked(p.x(), p.y(), p.z(), key))
    throw std::invalid_argument("octree: a point is not finite or too far out");
  return key;
}

/// Not pruned: each leaf is a cube of the resolution.
void occupy(octomap::OcTree& tree, const Eigen::Matrix3Xd& cloud) {
  if (cloud.cols() == 0) throw std::invalid_argument("octree: a cloud without points");
  constexpr bool kOccupied = true, kLazy = true;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i)
    tree.updateNode(key_of(tree, cloud.col(i)), kOccupied, kLazy);
}

double share_inside(const octomap::OcTree& tree, const Eigen::Matrix3Xd& cloud) {
  Eigen::Index inside = 0;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i)
    inside += tree.search(key_of(tree, cloud.col(i))) != nullptr;
  return static_cast<double>(inside) / static_cast<double>(cloud.cols());
}

}  // namespace

OctreeAgreement octree_agreement(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth,
                                 double resolution) {
  if (!(resolution > 0)) throw std::invalid_argument("octree: the resolution must be positive");
  octomap::OcTree of_estimate(resolution), of_truth(resolution);
  occupy(of_estimate, estimate);
  occupy(of_truth, truth);

  OctreeAgreement agreement;
  agreement.resolution = resolution;
  agreement.estimate_in_truth = share_inside(of_truth, estimate);
  agreement.truth_in_estimate = share_inside(of_estimate, truth);
  agreement.estimate_cubes = static_cast<int>(of_estimate.getNumLeafNodes());
  agreement.truth_cubes = static_cast<int>(of_truth.getNumLeafNodes());
  for (auto leaf = of_estimate.begin_leafs(); leaf != of_estimate.end_leafs(); ++leaf)
    agreement.shared_cubes += of_truth.search(leaf.getKey()) != nullptr;
  return agreement;
}

}  // namespace palpate::scores
