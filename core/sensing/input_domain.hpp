#pragma once

#include <Eigen/Core>

namespace palpate::sensing {

/// Where the answers of a learned model may be believed: near inputs that it was trained on, each
/// of which lies within `near` of one of `points`.
struct InputDomain {
  Eigen::MatrixXd points;     // inputs x points, in the units of the inputs; none: everywhere
  Eigen::VectorXd deviation;  // inputs, above 0: what counts as a distance of 1
  double near = 0;            // distance up to which an answer is believed wholly
  double far = 0;             // from which on it is not believed at all; above near

  /// 1 near the points, 0 far from all of them, a cubic without a kink in between. NaN is far.
  double trust(const Eigen::Ref<const Eigen::VectorXd>& input) const noexcept;

  /// Throws std::invalid_argument naming the part that does not fit `inputs` or the limits above.
  void check(int inputs) const;

  static constexpr int kLargestPoints = 1024;
};

/// `count` rows so chosen that the farthest of all rows is as near to one of them as a greedy
/// choice gets it (Gonzalez 1985), beginning with the row nearest to the mean; `near` and `far` are
/// what is left of that distance times the factors. rows: n x inputs, n above 0.
InputDomain cover(const Eigen::MatrixXd& rows, const Eigen::VectorXd& deviation, int count,
                  double near_factor, double far_factor);

}  // namespace palpate::sensing
