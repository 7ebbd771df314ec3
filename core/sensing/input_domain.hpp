#pragma once

#include <Eigen/Core>

namespace palpate::sensing {

/// Domain of validity of a learned model: the neighbourhood of its training inputs, each of which
/// lies within `near` of one of `points`.
struct InputDomain {
  Eigen::MatrixXd points;     // inputs x points, in the units of the inputs; empty: everywhere
  Eigen::VectorXd deviation;  // length inputs, > 0: scale of each input in the distance
  double near = 0;            // distance up to which the output has full weight
  double far = 0;             // distance from which it has zero weight; > near

  /// Weight of the output: 1 near the points, 0 far from all of them, a smooth cubic in between. 0
  /// for NaN.
  double trust(const Eigen::Ref<const Eigen::VectorXd>& input) const noexcept;

  /// Throws std::invalid_argument naming the part that does not match `inputs` or the limits above.
  void check(int inputs) const;

  static constexpr int kLargestPoints = 1024;
};

/// Selects `count` rows that minimise, greedily, the largest distance of any row to the nearest
/// selected one (Gonzalez 1985), starting with the row nearest to the mean; `near` and `far` are
/// the remaining distance times the factors. rows: n x inputs, n > 0.
InputDomain cover(const Eigen::MatrixXd& rows, const Eigen::VectorXd& deviation, int count,
                  double near_factor, double far_factor);

}  // namespace palpate::sensing
