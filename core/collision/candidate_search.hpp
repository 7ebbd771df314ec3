#pragma once

#include <vector>

#include "core/collision/box_tree.hpp"
#include "core/collision/obstacle.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::collision {

/// Sample of the surface near an obstacle.
struct Candidate {
  int sample = 0;
  int obstacle = 0;
};

/// Finds the samples of a deforming surface within a distance of obstacles, both of which may move.
/// The tree is refitted and asked only after a sample may have moved relative to an obstacle by the
/// skin since (Verlet 1967). Nothing allocates after construction.
class CandidateSearch {
 public:
  /// Node positions by column, of any outer stride.
  using Positions = Eigen::Ref<const Eigen::Matrix3Xd, 0, Eigen::OuterStride<>>;

  /// `samples`: their nodes are columns of the positions. `obstacles` must outlive this object;
  /// only their placements may change. `reach`: m, distance within which a sample is certainly
  /// found; `skin`: m, distance added.
  CandidateSearch(std::vector<mesh::PointWeights> samples, const std::vector<Obstacle>& obstacles,
                  double reach, double skin);

  const std::vector<mesh::PointWeights>& samples() const noexcept { return samples_; }

  /// All samples within the reach of an obstacle at `positions` and some within reach and skin,
  /// ordered by sample and obstacle.
  const std::vector<Candidate>& find(const Positions& positions) noexcept;
  /// Number of times that the tree was asked.
  long searches() const noexcept { return searches_; }

 private:
  void search(const Positions& positions) noexcept;
  bool is_still_valid(const Positions& positions) const noexcept;

  std::vector<mesh::PointWeights> samples_;
  const std::vector<Obstacle>& obstacles_;
  double reach_, skin_;
  double weight_sum_ = 1;  // largest sum of the absolute weights of a sample
  BoxTree tree_;
  Eigen::Matrix3Xd searched_at_;       // positions at the last search
  std::vector<math::Pose> placed_at_;  // X_OB of the obstacles at the last search
  std::vector<char> known_at_;         // whether they were placed
  std::vector<Candidate> candidates_;
  bool valid_ = false;
  long searches_ = 0;
};

/// Position, m, of a sample.
inline Eigen::Vector3d position(const mesh::PointWeights& sample,
                                const CandidateSearch::Positions& positions) noexcept {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i < sample.count; ++i) p += sample.weights[i] * positions.col(sample.nodes[i]);
  return p;
}

}  // namespace palpate::collision
