#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// How many times fewer samples than there are tell as much as independent ones: 1 + 2 sum rho_k
/// over the residuals' autocorrelation, summed in pairs of lags while they are positive (Geyer
/// 1992, initial positive sequence). 1 where rho_1 is within what white noise gives (1.96 /
/// sqrt(n)). Samples are taken in the order in which they stand.
double autocorrelation_factor(const Eigen::VectorXd& residuals);

/// Two-sided 95 % quantile of Student's t; `freedom` at least 1.
double student_quantile(double freedom);

}  // namespace palpate::fit
