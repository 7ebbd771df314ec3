#pragma once

#include "core/shape/feature.hpp"

namespace palpate::control {

/// J = sum over the support of (d feature / d x_i) (d x_i / d xi). `node_motion(node)` returns the
/// 3 x 6 block d x_i / d xi. Costs six products per entry of the feature's own Jacobian. Does not
/// allocate.
template <class NodeMotion>
void accumulate_support(const shape::Feature& feature, const NodeMotion& node_motion,
                        Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  J.setZero();
  const Eigen::SparseMatrix<double>& H = feature.jacobian();
  const std::vector<int>& support = feature.support();
  for (int i = 0; i < static_cast<int>(support.size()); ++i) {
    const Eigen::Matrix<double, 3, 6> block = node_motion(support[i]);
    for (int k = 0; k < 3; ++k) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(H, 3 * i + k); entry; ++entry) {
        J.row(entry.row()) += entry.value() * block.row(k);
      }
    }
  }
}

}  // namespace palpate::control
