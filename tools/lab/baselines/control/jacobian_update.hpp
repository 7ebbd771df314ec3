#pragma once

#include "core/math/rigid.hpp"

namespace palpate::baselines {

/// Motion of the hand in lengths only: displacement in m, rotation times a length in m.
using ScaledMotion = math::Vector6d;

/// Learns a Jacobian from pairs of a hand's motion and the resulting change of a feature. J: rows x
/// 6, with respect to ScaledMotion.
class JacobianUpdate {
 public:
  virtual ~JacobianUpdate() = default;
  /// Allocates for a feature with this number of rows and clears the state.
  virtual void resize(int rows) = 0;
  virtual void forget() noexcept {}
  /// `probe`: one of the initial probing motions, from which J has been computed already.
  virtual void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
                     Eigen::MatrixXd& J) noexcept = 0;
};

}  // namespace palpate::baselines
