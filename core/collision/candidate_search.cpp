#include "core/collision/candidate_search.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::collision {

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
}

void CandidateSearch::search(const Positions& positions) noexcept {
  ++searches_;
  searched_at_ = positions.leftCols(searched_at_.cols());
  candidates_.clear();
  tree_.refit([&](int s) { return Eigen::AlignedBox3d(position(samples_[s], positions)); });
  for (int o = 0; o < static_cast<int>(obstacles_.size()); ++o) {
    const Obstacle& obstacle = obstacles_[o];
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
  const double limit = skin_ / weight_sum_;
  if (valid_) {
    const auto moved = (positions.leftCols(searched_at_.cols()) - searched_at_).colwise();
    valid_ = moved.squaredNorm().maxCoeff() <= limit * limit;
  }
  if (!valid_) search(positions);
  valid_ = true;
  return candidates_;
}

}  // namespace palpate::collision
