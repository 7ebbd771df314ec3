#include "core/collision/candidate_search.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::collision {
namespace {

/// Largest displacement, m, of the points of a box that move like an obstacle from one pose to
/// another: as a convex function of the point it is greatest at a corner.
double largest_displacement(const math::Pose& from, const math::Pose& to,
                            const Eigen::AlignedBox3d& box) noexcept {
  const Eigen::Matrix3d turn =
      to.linear() * from.linear().transpose() - Eigen::Matrix3d::Identity();
  const Eigen::Vector3d shift =
      to.translation() - (turn + Eigen::Matrix3d::Identity()) * from.translation();
  double squared = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
    squared = std::max(squared, (turn * box.corner(type) + shift).squaredNorm());
  }
  return std::sqrt(squared);
}

}  // namespace

CandidateSearch::CandidateSearch(std::vector<mesh::PointWeights> samples,
                                 const std::vector<Obstacle>& obstacles, double reach, double skin)
    : samples_(std::move(samples)),
      obstacles_(obstacles),
      reach_(reach),
      skin_(skin),
      tree_(std::vector<Eigen::AlignedBox3d>(samples_.size(),
                                             Eigen::AlignedBox3d(Eigen::Vector3d::Zero()))) {
  int nodes = 0;
  for (const mesh::PointWeights& sample : samples_) {
    double sum = 0;
    for (int i = 0; i < sample.count; ++i) {
      nodes = std::max(nodes, sample.nodes[i] + 1);
      sum += std::abs(sample.weights[i]);
    }
    weight_sum_ = std::max(weight_sum_, sum);
  }
  searched_at_.setZero(3, nodes);
  candidates_.reserve(samples_.size() * obstacles_.size());
  placed_at_.resize(obstacles_.size(), math::Pose::Identity());
  known_at_.resize(obstacles_.size(), 0);
}

void CandidateSearch::search(const Positions& positions) noexcept {
  ++searches_;
  searched_at_ = positions.leftCols(searched_at_.cols());
  candidates_.clear();
  tree_.refit([&](int s) { return Eigen::AlignedBox3d(position(samples_[s], positions)); });
  for (int o = 0; o < static_cast<int>(obstacles_.size()); ++o) {
    const Obstacle& obstacle = obstacles_[o];
    placed_at_[o] = obstacle.X_OB;
    known_at_[o] = obstacle.is_known ? 1 : 0;
    tree_.visit(
        [&](const Eigen::AlignedBox3d& box) {
          const Eigen::Vector3d center = box.center();
          return distance(obstacle, center) <= reach_ + skin_ + 0.5 * box.diagonal().norm();
        },
        [&](int s) {
          candidates_.push_back({s, o});
        });
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.obstacle < b.obstacle;
  });
}

const std::vector<Candidate>& CandidateSearch::find(const Positions& positions) noexcept {
  if (!valid_ || !is_still_valid(positions)) search(positions);
  valid_ = true;
  return candidates_;
}

bool CandidateSearch::is_still_valid(const Positions& positions) const noexcept {
  double left = skin_;
  const Eigen::AlignedBox3d reached(tree_.bounds().min().array() - skin_,
                                    tree_.bounds().max().array() + skin_);
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const Obstacle& obstacle = obstacles_[o];
    if (obstacle.is_known != (known_at_[o] != 0)) return false;
    if (!obstacle.is_known || obstacle.X_OB.matrix() == placed_at_[o].matrix()) continue;
    left = std::min(left, skin_ - largest_displacement(obstacle.X_OB, placed_at_[o], reached));
  }
  if (!(left > 0)) return false;
  const double limit = left / weight_sum_;
  const auto moved = (positions.leftCols(searched_at_.cols()) - searched_at_).colwise();
  return moved.squaredNorm().maxCoeff() <= limit * limit;
}

}  // namespace palpate::collision
