#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// Ratio of the number of samples to the effective number of independent ones: 1 + 2 sum rho_k over
/// the residuals' autocorrelation, summed in pairs of lags while they are positive (Geyer 1992,
/// initial positive sequence). 1 if rho_1 is within the range of white noise (1.96 / sqrt(n)).
/// Samples are taken in their order.
double autocorrelation_factor(const Eigen::VectorXd& residuals);

/// Two-sided 95 % quantile of Student's t; `freedom` at least 1.
double student_quantile(double freedom);

}  // namespace palpate::fit
