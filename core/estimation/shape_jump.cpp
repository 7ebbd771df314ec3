#include "core/estimation/shape_jump.hpp"

namespace palpate::estimation {

// Fraction of the longest side of the bounding box; m/s.
constexpr double kShare = 0.01, kSpeed = 2;

ShapeJump::ShapeJump(const Eigen::Matrix3Xd& rest)
    : share_of_size_(kShare * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).maxCoeff()),
      last_(rest) {}

bool ShapeJump::update(const Eigen::Matrix3Xd& positions, double dt) noexcept {
  const double most = share_of_size_ + kSpeed * dt;
  bool jumped = false;
  for (Eigen::Index node = 0; known_ && node < positions.cols(); ++node)
    jumped = jumped || !((positions.col(node) - last_.col(node)).squaredNorm() <= most * most);
  last_ = positions;
  known_ = true;
  return jumped;
}

}  // namespace palpate::estimation
