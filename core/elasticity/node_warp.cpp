#include "core/elasticity/node_warp.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::elasticity {
namespace {

/// v <- M v for each node, entry (r, c) of M at r * kRow + c * kColumn.
template <int kRow, int kColumn>
void multiply(const Eigen::VectorXf& matrices, Eigen::VectorXf& v) noexcept {
  const float* m = matrices.data();
  for (float* p = v.data(); m != matrices.data() + matrices.size(); m += 9, p += 3) {
    const float x = p[0], y = p[1], z = p[2];
    for (int r = 0; r < 3; ++r) {
      p[r] = m[r * kRow] * x + m[r * kRow + kColumn] * y + m[r * kRow + 2 * kColumn] * z;
    }
  }
}

}  // namespace

NodeWarp::NodeWarp(int nodes) : nodes_(nodes), matrices_(Eigen::VectorXf::Zero(9 * nodes)) {
  for (int i = 0; i < nodes; ++i)
    matrices_[9 * i] = matrices_[9 * i + 4] = matrices_[9 * i + 8] = 1;
}

void NodeWarp::update(const Eigen::Matrix4Xf& now, const Eigen::Matrix4Xf& snapshot) noexcept {
  float least = 1;
  for (int i = 0; i < nodes_; ++i) {
    // now * conjugate(snapshot)
    const Eigen::Vector4f p = now.col(i), q = snapshot.col(i);
    const Eigen::Vector4f r(p(0) * q(0) + p(1) * q(1) + p(2) * q(2) + p(3) * q(3),
                            p(1) * q(0) - p(0) * q(1) - p(2) * q(3) + p(3) * q(2),
                            p(2) * q(0) - p(0) * q(2) - p(3) * q(1) + p(1) * q(3),
                            p(3) * q(0) - p(0) * q(3) - p(1) * q(2) + p(2) * q(1));
    least = std::min(least, std::abs(r(0)));
    const float w = r(0), x = r(1), y = r(2), z = r(3);
    float* m = matrices_.data() + 9 * i;
    m[0] = 1 - 2 * (y * y + z * z);
    m[1] = 2 * (x * y + w * z);
    m[2] = 2 * (x * z - w * y);
    m[3] = 2 * (x * y - w * z);
    m[4] = 1 - 2 * (x * x + z * z);
    m[5] = 2 * (y * z + w * x);
    m[6] = 2 * (x * z + w * y);
    m[7] = 2 * (y * z - w * x);
    m[8] = 1 - 2 * (x * x + y * y);
  }
  largest_ = 2 * std::acos(static_cast<double>(least));
}

void NodeWarp::turn(Eigen::VectorXf& v) const noexcept { multiply<1, 3>(matrices_, v); }
void NodeWarp::turn_back(Eigen::VectorXf& v) const noexcept { multiply<3, 1>(matrices_, v); }

}  // namespace palpate::elasticity
