#pragma once

#include "core/math/rigid.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

/// The motion of a grasp that moves a feature as wished, in the least-squares sense, and of all
/// such motions the smallest: u = J^+ s. Metres and radians are made comparable by a length L:
/// |u|^2 = |v|^2 + L^2 |w|^2, and rotation rows of the feature count L times, curvatures L^2 times.
/// Two grasps may move together: u is then the first one's motion above the second one's. Works on
/// the eigenvectors of the 6 x 6 or 12 x 12 normal matrix, so after set_up() nothing allocates
/// whatever the feature.
class PseudoInverse {
 public:
  struct Options {
    double length = 0.25;  // m, > 0, rotation by 1 rad weighs as much as this displacement
    /// Singular values s below eps = damping * (the largest) act as s / eps^2 in place of 1 / s:
    /// exact away from singularities, fading to rest in them (numerical filtering, Maciejewski and
    /// Klein 1988).
    double damping = 0.02;
    /// Directions with a singular value below this fraction of the largest cannot be reached.
    double rank_tolerance = 5e-3;
    int grasps = 1;  // 1 or 2 that move
  };
  /// Motion of the grasps, (v, w) of each, in m/s and rad/s.
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;

  /// Throws std::invalid_argument where an option is out of range.
  explicit PseudoInverse(const Options& options);

  /// What the rows of the feature count in. Allocates.
  void set_up(const shape::Feature& feature);

  /// Takes J, dimension x 6 or 12. False where it is not finite or zero; then nothing can be
  /// reached.
  bool decompose(const Eigen::MatrixXd& J) noexcept;

  /// J^+ s, damped. s: dimension long.
  Motion solve(const Eigen::VectorXd& s) noexcept;

  /// (I - J J^+) e with the rank tolerance: what no motion removes, least squares in scaled rows.
  void unreachable(const Eigen::VectorXd& e, Eigen::VectorXd& out) noexcept;

  /// 1 on rows in metres, L on rows in radians, L^2 on rows in 1/m.
  const Eigen::VectorXd& row_scale() const noexcept { return row_scale_; }

 private:
  using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;
  int columns() const noexcept { return 6 * options_.grasps; }
  double greatest() const noexcept { return lambda_[columns() - 1]; }

  Options options_;
  Eigen::VectorXd row_scale_;
  Eigen::VectorXd scaled_;  // a vector of the feature in scaled rows
  Motion column_scale_;     // 1 / L on rotations
  Eigen::MatrixXd J_;       // scaled
  Normal V_;
  Motion lambda_;  // squares of the singular values, ascending
};

}  // namespace palpate::control
