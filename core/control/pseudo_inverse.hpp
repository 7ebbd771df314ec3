#pragma once

#include "core/math/rigid.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

/// Least-squares motion of the grasp that produces a given motion of the feature, with the smallest
/// norm: u = J^+ s. Metres and radians are made comparable by a length L: |u|^2 = |v|^2 + L^2
/// |w|^2; rotation rows of the feature are multiplied by L, curvatures by L^2. With two moving
/// grasps, u is the first one's motion followed by the second one's. Uses the eigenvectors of the 6
/// x 6 or 12 x 12 normal matrix, therefore nothing allocates after set_up(), whatever the feature.
class PseudoInverse {
 public:
  struct Options {
    double length = 0.25;  // m, > 0: a rotation of 1 rad weighs as much as this displacement
    /// Singular values s below eps = damping * (largest singular value) act as s / eps^2 instead of
    /// 1 / s: exact away from singularities, zero motion in them (numerical filtering, Maciejewski
    /// and Klein 1988).
    double damping = 0.02;
    /// Directions with a singular value below this fraction of the largest count as unreachable.
    double rank_tolerance = 5e-3;
    int grasps = 1;  // number of moving grasps, 1 or 2
  };
  /// Motion of the grasps, (v, w) of each, in m/s and rad/s.
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;

  /// Throws std::invalid_argument if an option is out of range.
  explicit PseudoInverse(const Options& options);

  /// Sets the units of the feature's rows. Allocates.
  void set_up(const shape::Feature& feature);

  /// Decomposes J, dimension x 6 or 12. False if it is not finite or zero; then nothing is
  /// reachable.
  bool decompose(const Eigen::MatrixXd& J) noexcept;

  /// J^+ s, damped. s: length dimension().
  Motion solve(const Eigen::VectorXd& s) noexcept;

  /// (I - J J^+) e with the rank tolerance: the part of e that no motion removes, least squares in
  /// scaled rows.
  void unreachable(const Eigen::VectorXd& e, Eigen::VectorXd& out) noexcept;

  /// 1 for rows in metres, L for rows in radians, L^2 for rows in 1/m.
  const Eigen::VectorXd& row_scale() const noexcept { return row_scale_; }

 private:
  using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;
  int columns() const noexcept { return 6 * options_.grasps; }
  double greatest() const noexcept { return lambda_[columns() - 1]; }

  Options options_;
  Eigen::VectorXd row_scale_;
  Eigen::VectorXd scaled_;  // vector of the feature in scaled rows
  Motion column_scale_;     // 1 / L for rotations
  Eigen::MatrixXd J_;       // scaled
  Normal V_;
  Motion lambda_;  // squares of the singular values, ascending
};

}  // namespace palpate::control
