#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate::collect {

/// Minimum of `cost`, searched from `start` with a simplex of these `steps` (Nelder and Mead 1965)
/// in at most `evaluations`. Needs no derivatives; finds a local minimum. The cost may be infinite.
Eigen::VectorXd minimise(const std::function<double(const Eigen::VectorXd&)>& cost,
                         const Eigen::VectorXd& start, const Eigen::VectorXd& steps,
                         int evaluations);

}  // namespace palpate::collect
