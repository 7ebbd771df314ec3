#include "core/elasticity/sensitivity.hpp"

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

using Eigen::Matrix3d;

/// [T m_1 R^T, T m_2 R^T, ..] for the 3 x 3 blocks m of a block row.
template <class From, class To>
void turn_blocks(const Matrix3d& left, const From& from, const Matrix3d& right, To&& to) {
  for (int c = 0; c < from.cols(); c += 3) {
    const Matrix3d m = from.template middleCols<3>(c) * right.transpose();
    to.template middleCols<3>(c) = left * m;
  }
}

template <class Wrench>
void turn_wrench(const Matrix3d& left, const Wrench& from, const Matrix3d& right, Wrench& to) {
  turn_blocks(left, from.template topRows<3>(), right, to.template topRows<3>());
  turn_blocks(left, from.template bottomRows<3>(), right, to.template bottomRows<3>());
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

void Sensitivity::resize(int nodes, int free_directions) {
  for (Motion& m : dx_dxi) m.setZero(3 * nodes, 6);
  for (auto& row : dw_dxi) {
    for (math::Matrix6d& m : row) m.setZero();
  }
  dx_dparameter.setZero(3 * nodes, 3);
  for (auto& m : dw_dparameter) m.setZero();
  for (auto& w : reaction) w.setZero();
  for (auto& m : dx_dforce) m.setZero(3 * nodes, 3);
  for (auto& of_obstacle : dcontact_dxi) {
    for (auto& row : of_obstacle) row.setZero();
  }
  for (auto& row : dw_dforce) {
    for (auto& m : row) m.setZero();
  }
  dx_dobstacle.setZero(3 * nodes, free_directions);
  for (auto& m : dw_dobstacle) m.setZero(6, free_directions);
  for (auto& row : dcontact_dobstacle) row.setZero(free_directions);
}

void turn(const Sensitivity& snapshot, const Turned& turned, int begin, int end,
          Sensitivity& now) noexcept {
  const Matrix3d identity = Matrix3d::Identity();
  for (int node = begin; node < end; ++node) {
    const int k = turned.numbering[node];
    if (k >= turned.nodes.size()) continue;
    const Matrix3d w = turned.nodes.matrix(k).cast<double>();
    for (int g = 0; g < 2; ++g) {
      if (!turned.is_held[g]) continue;
      turn_blocks(w, snapshot.dx_dxi[g].middleRows<3>(3 * node), turned.grasps[g],
                  now.dx_dxi[g].middleRows<3>(3 * node));
    }
    turn_blocks(w, snapshot.dx_dparameter.middleRows<3>(3 * node), identity,
                now.dx_dparameter.middleRows<3>(3 * node));
    now.dx_dobstacle.middleRows<3>(3 * node) =
        w.lazyProduct(snapshot.dx_dobstacle.middleRows<3>(3 * node));
    for (int c = 0; c < kContactSlots; ++c) {
      if (!turned.is_watched[c]) continue;
      turn_blocks(w, snapshot.dx_dforce[c].middleRows<3>(3 * node), turned.contacts[c],
                  now.dx_dforce[c].middleRows<3>(3 * node));
    }
  }
  for (int a = 0; a < 2; ++a) {
    const Matrix3d& w = turned.grasps[a];
    for (int b = 0; b < 2; ++b) {
      turn_wrench(w, snapshot.dw_dxi[a][b], turned.grasps[b], now.dw_dxi[a][b]);
    }
    now.reaction[a] = math::both_halves(w) * snapshot.reaction[a];
    for (int k = 0; k < 3; ++k) {
      now.dw_dparameter[a].col(k).head<3>() = w * snapshot.dw_dparameter[a].col(k).head<3>();
      now.dw_dparameter[a].col(k).tail<3>() = w * snapshot.dw_dparameter[a].col(k).tail<3>();
    }
    now.dw_dobstacle[a] = math::both_halves(w).lazyProduct(snapshot.dw_dobstacle[a]);
    for (int c = 0; c < kContactSlots; ++c) {
      turn_wrench(w, snapshot.dw_dforce[a][c], turned.contacts[c], now.dw_dforce[a][c]);
    }
  }
  for (std::size_t o = 0; o < now.dcontact_dxi.size(); ++o) {
    for (int g = 0; g < 2; ++g)
      now.dcontact_dxi[o][g] =
          snapshot.dcontact_dxi[o][g].lazyProduct(math::both_halves(turned.grasps[g]).transpose());
  }
  now.dcontact_dobstacle = snapshot.dcontact_dobstacle;
  now.smallest_pivot = snapshot.smallest_pivot;
  now.valid = snapshot.valid;
}

}  // namespace palpate::elasticity
