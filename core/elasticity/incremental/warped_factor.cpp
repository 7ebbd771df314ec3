#include "core/elasticity/incremental/warped_factor.hpp"

#include <algorithm>
#include <utility>

namespace palpate::elasticity {

SecantPairs::SecantPairs(int size) {
  for (Pair& pair : pairs_) {
    pair.step.setZero(size);
    pair.change.setZero(size);
  }
}

void SecantPairs::add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept {
  const float curvature = dot(step, change);
  if (!(curvature > 1e-5F * step.norm() * change.norm())) return;
  Pair& pair = pairs_[next_];
  pair.step = step;
  pair.change = change;
  pair.scale = 1 / curvature;
  next_ = (next_ + 1) % kPairs;
  count_ = std::min(count_ + 1, kPairs);
}

WarpedFactor::WarpedFactor(const NumberedBody& body, const SolverOptions& options,
                           const std::vector<mesh::PointWeights>& samples)
    : options_(options),
      factor_(body, options, samples),
      rotations_(factor_.rotations),
      warp_(body.pattern.size()),
      secants_(3 * body.pattern.size()) {}

void WarpedFactor::solve(Eigen::VectorXf& b, const BoundaryConditions& boundary) noexcept {
  boundary.clear_held_nodes(b);
  secants_.apply(b, [&](Eigen::VectorXf& v) {
    warp_.turn_back(v);
    factor_.panels.solve(v.data(), boundary.held());
    warp_.turn(v);
  });
}

void WarpedFactor::solve_unturned(Eigen::VectorXf& b, const BoundaryConditions& boundary) noexcept {
  boundary.clear_held_nodes(b);
  factor_.panels.solve(b.data(), boundary.held());
}

const Eigen::Matrix4Xf& WarpedFactor::measure_rotations(ElementForces& elements) noexcept {
  elements.node_rotations(rotations_);
  return rotations_;
}

void WarpedFactor::follow(ElementForces& elements) noexcept {
  warp_.update(measure_rotations(elements), factor_.rotations);
  if (warp_.largest() > options_.turned) wanted_ = true;
}

void WarpedFactor::install(LoopFactor& computed, double age, ElementForces& elements) noexcept {
  std::swap(factor_, computed);
  age_ = age;
  secants_.clear();
  follow(elements);
}

void WarpedFactor::reset() noexcept {
  rotations_.setZero();
  rotations_.row(0).setOnes();
  warp_.update(rotations_, factor_.rotations);
  secants_.clear();
  wanted_ = true;
}

}  // namespace palpate::elasticity
