#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "core/math/rigid.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::scores {

/// Standard deviations that a node's 95 % ball spans: square root of the 95 % quantile of
/// chi-squared with 3 degrees of freedom.
inline constexpr double kBall = 2.7955;

/// Errors of nodes compared with their reported standard deviations. A node without one (it is
/// fixed, or its deviation is not observable) does not count.
class NodeBelief {
 public:
  /// error: m, of each node of a shape that reports deviations.
  void add(const shape_t& shape, const Eigen::RowVectorXd& error);

  long count() const { return count_; }
  long inside() const { return inside_; }
  /// Share of the nodes within their 95 % balls; empty without a node, as the next one.
  std::optional<double> covered() const { return mean(static_cast<double>(inside_)); }
  /// Mean squared error over three variances (NEES, Bar-Shalom et al. 2001, 5.4), 1 where the
  /// deviations are right; of each node's equal share of the three axes.
  std::optional<double> normalised_square() const { return mean(squares_); }
  double mean_deviation() const { return mean(deviations_).value_or(0); }  // m

 private:
  std::optional<double> mean(double sum) const {
    if (count_ == 0) return std::nullopt;
    return sum / static_cast<double>(count_);
  }

  long count_ = 0, inside_ = 0;
  double squares_ = 0, deviations_ = 0;
};

/// Calls `take` with each shape that reports deviations and the distances of its nodes from the
/// truth (m). X_OP: pose of the plant's O (P) in palpated's O. Throws std::runtime_error if the log
/// lacks meshes.
void visit_node_errors(const log::RunLog& run, const math::Pose& X_OP,
                       const std::function<void(const shape_t&, const Eigen::RowVectorXd&)>& take);

}  // namespace palpate::scores
