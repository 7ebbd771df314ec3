#include "core/elasticity/sensitivity.hpp"

namespace palpate::elasticity {
namespace {

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

void Sensitivity::resize(int nodes) {
  for (Motion& m : dx_dxi) m.setZero(3 * nodes, 6);
  for (auto& row : dw_dxi) {
    for (math::Matrix6d& m : row) m.setZero();
  }
  dx_dparameter.setZero(3 * nodes, 3);
  for (auto& m : dw_dparameter) m.setZero();
  for (auto& m : dx_dforce) m.setZero(3 * nodes, 3);
  for (auto& row : dw_dforce) {
    for (auto& m : row) m.setZero();
  }
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
    for (int k = 0; k < 3; ++k) {
      now.dw_dparameter[a].col(k).head<3>() = w * snapshot.dw_dparameter[a].col(k).head<3>();
      now.dw_dparameter[a].col(k).tail<3>() = w * snapshot.dw_dparameter[a].col(k).tail<3>();
    }
    for (int c = 0; c < kContactSlots; ++c) {
      turn_wrench(w, snapshot.dw_dforce[a][c], turned.contacts[c], now.dw_dforce[a][c]);
    }
  }
  now.smallest_pivot = snapshot.smallest_pivot;
  now.valid = snapshot.valid;
}

}  // namespace palpate::elasticity
