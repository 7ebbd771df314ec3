#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// A stress over time and its derivatives by parameters (one column each).
struct StressHistory {
  Eigen::VectorXd stress;
  Eigen::MatrixXd by_parameter;
};

/// Stress of a Maxwell branch in parallel with a spring, i.e. the standard linear solid: q' = g P'
/// - q / tau, exact for a P that is linear between samples (Simo and Hughes 1998, section 10.3). At
/// the first sample q is 0. The columns of g and tau are added to.
StressHistory relaxing_part(const StressHistory& elastic, const Eigen::VectorXd& time, double ratio,
                            double relaxation_time, Eigen::Index ratio_column,
                            Eigen::Index time_column);

}  // namespace palpate::fit
