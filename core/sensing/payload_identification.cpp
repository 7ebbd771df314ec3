#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"
#include "core/math/singular_values.hpp"
#include "core/sensing/payload.hpp"

namespace palpate::sensing {
namespace {

// The ratio of force and torque noise converges in two.
constexpr int kPasses = 3;
// Combinations of parameters that the readings excite less than the best one by more than this
// factor (unit columns) are not identifiable.
constexpr double kConditionLimit = 1e4;
// Component of a unit vector above which a parameter counts as not identifiable.
constexpr double kUnidentifiedShare = 0.1;

}  // namespace

/// Rows are weighted by the inverse scale of their residuals, determined iteratively, because force
/// and torque differ in unit and noise.
PayloadFit identify_payload(const std::vector<MotionSample>& samples) {
  constexpr int k = kPayloadParameterCount;
  const int n = static_cast<int>(samples.size());
  math::check_option(n >= 4, "samples", n, "at least 4 readings");

  Eigen::MatrixXd regressor(6 * n, k);
  Eigen::VectorXd measured(6 * n);
  for (int s = 0; s < n; ++s) {
    regressor.middleRows<6>(6 * s) = load_regressor(samples[s].motion);
    measured.segment<6>(6 * s) = samples[s].F_S.vector();
  }
  math::check_all_finite(regressor, "samples: motion");
  math::check_all_finite(measured, "samples: wrench");

  PayloadFit fit;
  fit.sample_count = n;
  Eigen::Matrix<double, 6, Eigen::Dynamic> residuals(6, n);
  Eigen::Matrix<double, 6, Eigen::Dynamic> weights(6, n);
  // Initial guess: the error of a torque is that of a force times a lever of 0.1 m.
  weights.topRows<3>().setConstant(1.0);
  weights.bottomRows<3>().setConstant(10.0);
  Eigen::VectorXd solution(k), variance(k);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::Map<const Eigen::VectorXd> row_weights(weights.data(), 6 * n);
    Eigen::MatrixXd weighted = row_weights.asDiagonal() * regressor;
    const Eigen::VectorXd column_norms = weighted.colwise().norm().transpose();
    const double largest_norm = column_norms.maxCoeff();
    // a column without excitation keeps its scale and appears as a small singular value
    Eigen::VectorXd scale(k);
    for (int c = 0; c < k; ++c)
      scale[c] = column_norms[c] > 1e-12 * largest_norm ? 1.0 / column_norms[c] : 1.0;
    weighted = weighted * scale.asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(weighted,
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& sigma = svd.singularValues();

    fit.condition = sigma[0] / std::max(sigma[k - 1], 1e-300);
    const Eigen::VectorXd projected =
        svd.matrixU().transpose() * row_weights.cwiseProduct(measured);
    solution.setZero();
    variance.setZero();
    Eigen::VectorXd lost = Eigen::VectorXd::Zero(k);
    for (int j = 0; j < k; ++j) {
      const Eigen::VectorXd direction = svd.matrixV().col(j);
      if (sigma[j] * kConditionLimit > sigma[0]) {
        solution += direction * (projected[j] / sigma[j]);
        variance += direction.cwiseAbs2() / (sigma[j] * sigma[j]);
      } else {
        lost += direction.cwiseAbs2();
      }
    }
    solution = solution.cwiseProduct(scale);
    variance = variance.cwiseProduct(scale.cwiseAbs2());
    fit.unidentified.clear();
    for (int c = 0; c < k; ++c)
      if (lost[c] > kUnidentifiedShare * kUnidentifiedShare)
        fit.unidentified.emplace_back(payload_parameter_name(c));

    const Eigen::VectorXd error = measured - regressor * solution;
    residuals = Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>(error.data(), 6, n);
    for (const int first_row : {0, 3}) {
      const auto rows = residuals.middleRows<3>(first_row);
      const double rms = std::sqrt(rows.squaredNorm() / static_cast<double>(rows.size()));
      weights.middleRows<3>(first_row).setConstant(1.0 / std::max(rms, 1e-12));
    }
  }

  // rows are scaled to unit noise: the variance needs only the correction for degrees of freedom
  const double inflation = 6.0 * n > k ? 6.0 * n / (6.0 * n - k) : 1.0;
  fit.parameters = payload_from_vector(solution);
  fit.deviation = (inflation * variance).cwiseSqrt();
  fit.residual_rms = (residuals.rowwise().squaredNorm() / n).cwiseSqrt();
  fit.force_rms = fit.residual_rms.head<3>().norm();
  fit.torque_rms = fit.residual_rms.tail<3>().norm();
  return fit;
}

}  // namespace palpate::sensing
