#pragma once

#include "core/math/rigid.hpp"

namespace palpate::published_control {

/// A motion of the hand with lengths alone: displacement in m, rotation times a length in m.
using ScaledMotion = math::Vector6d;

/// How a Jacobian is learnt from pairs of a hand's motion and what it has done to a feature. J:
/// rows x 6, by ScaledMotion.
class JacobianUpdate {
 public:
  virtual ~JacobianUpdate() = default;
  /// Room for a feature of so many rows; forgets. Allocates.
  virtual void resize(int rows) = 0;
  virtual void forget() noexcept {}
  /// `probe`: one of the first motions, from whose whole J has been found already.
  virtual void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
                     Eigen::MatrixXd& J) noexcept = 0;
};

}  // namespace palpate::published_control
