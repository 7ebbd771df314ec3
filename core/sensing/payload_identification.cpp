#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"
#include "core/math/singular_values.hpp"
#include "core/sensing/payload.hpp"

namespace palpate::sensing {
namespace {

constexpr double kHuber = 1.345;  // standard deviations; 95 % efficiency for normal noise
// Unweighted passes; the ratio of force and torque noise converges in two.
constexpr int kPlainPasses = 3;
constexpr int kRobustPasses = 20;
// Component of a unit vector above which a parameter counts as not identifiable.
constexpr double kUnidentifiedShare = 0.1;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Root mean square, or its robust counterpart, of the residuals of force or torque axes.
double scale_of(const Eigen::Matrix<double, 6, Eigen::Dynamic>& residuals, int first_row,
                bool robust) {
  const auto rows = residuals.middleRows<3>(first_row);
  if (!robust) return std::sqrt(rows.squaredNorm() / static_cast<double>(rows.size()));
  std::vector<double> magnitudes;
  magnitudes.reserve(static_cast<std::size_t>(rows.size()));
  for (int c = 0; c < rows.cols(); ++c)
    for (int r = 0; r < 3; ++r) magnitudes.push_back(std::abs(rows(r, c)));
  return 1.4826 * median(magnitudes);
}

constexpr int kColumnCount = kPayloadParameterCount + 6;  // plus six of drift

Eigen::Matrix<double, 6, kColumnCount> columns_of(const MotionSample& sample) {
  Eigen::Matrix<double, 6, kColumnCount> columns;
  columns.leftCols<kPayloadParameterCount>() = load_regressor(sample.motion);
  columns.rightCols<6>() = sample.time * math::Matrix6d::Identity();
  return columns;
}

std::string column_name(int column) {
  if (column < kPayloadParameterCount) return payload_parameter_name(column);
  // drift parameters are named after their bias, "bias_fx"
  return std::string("drift_of_") + payload_parameter_name(column - 6);
}

/// Least squares over `columns` of the regressor; rows are weighted by the inverse scale of their
/// residuals, determined iteratively, because force and torque differ in unit and noise.
PayloadFit identify(const std::vector<MotionSample>& samples, std::vector<int> columns,
                    const IdentificationOptions& options) {
  if (options.bias_drifts)
    for (int c = kPayloadParameterCount; c < kColumnCount; ++c) columns.push_back(c);
  const int n = static_cast<int>(samples.size());
  const int k = static_cast<int>(columns.size());
  math::check_option(n >= 4, "samples", n, "at least 4 readings");

  Eigen::MatrixXd regressor(6 * n, k);
  Eigen::VectorXd measured(6 * n);
  for (int s = 0; s < n; ++s) {
    const Eigen::Matrix<double, 6, kColumnCount> full = columns_of(samples[s]);
    for (int c = 0; c < k; ++c) regressor.block<6, 1>(6 * s, c) = full.col(columns[c]);
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
  const int passes = options.robust ? kRobustPasses : kPlainPasses;
  for (int pass = 0; pass < passes; ++pass) {
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
      if (sigma[j] * options.condition_limit > sigma[0]) {
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
        fit.unidentified.push_back(column_name(columns[c]));

    const Eigen::VectorXd error = measured - regressor * solution;
    residuals = Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>(error.data(), 6, n);
    for (const int first_row : {0, 3}) {
      const double deviation = std::max(scale_of(residuals, first_row, options.robust), 1e-12);
      for (int s = 0; s < n; ++s)
        for (int r = first_row; r < first_row + 3; ++r) {
          const double size = std::abs(residuals(r, s)) / deviation;
          const double trust = options.robust && size > kHuber ? std::sqrt(kHuber / size) : 1.0;
          weights(r, s) = trust / deviation;
        }
    }
  }

  Eigen::Matrix<double, kColumnCount, 1> parameters, deviations;
  parameters.setZero();
  deviations.setZero();
  // rows are scaled to unit noise: the variance needs only the correction for degrees of freedom
  const double inflation = 6.0 * n > k ? 6.0 * n / (6.0 * n - k) : 1.0;
  for (int c = 0; c < k; ++c) {
    parameters[columns[c]] = solution[c];
    deviations[columns[c]] = std::sqrt(inflation * variance[c]);
  }
  fit.parameters = payload_from_vector(parameters.head<kPayloadParameterCount>());
  fit.bias_drift = math::Wrench::from(parameters.tail<6>());
  fit.deviation = deviations.head<kPayloadParameterCount>();
  fit.residual_rms = (residuals.rowwise().squaredNorm() / n).cwiseSqrt();
  fit.force_rms = fit.residual_rms.head<3>().norm();
  fit.torque_rms = fit.residual_rms.tail<3>().norm();
  return fit;
}

}  // namespace

PayloadFit identify_static(const std::vector<StaticPose>& poses, const Eigen::Vector3d& gravity_W,
                           const IdentificationOptions& options) {
  std::vector<MotionSample> samples;
  samples.reserve(poses.size());
  for (const StaticPose& pose : poses)
    samples.push_back({motion_at_rest(pose.R_WS, gravity_W), pose.F_S, pose.time});
  return identify(samples, {0, 1, 2, 3, 10, 11, 12, 13, 14, 15}, options);
}

Eigen::Vector3d estimate_gravity_direction(const std::vector<StaticPose>& poses) {
  const int n = static_cast<int>(poses.size());
  math::check_option(n >= 4, "poses", n, "at least 4");
  // F = bias - R_SW (m g): linear in the weight in W and the bias in S
  Eigen::MatrixXd regressor(3 * n, 6);
  Eigen::VectorXd measured(3 * n);
  for (int i = 0; i < n; ++i) {
    regressor.block<3, 3>(3 * i, 0) = -poses[i].R_WS.transpose();
    regressor.block<3, 3>(3 * i, 3).setIdentity();
    measured.segment<3>(3 * i) = poses[i].F_S.force;
  }
  math::check_all_finite(regressor, "poses: rotation");
  math::check_all_finite(measured, "poses: force");
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(regressor, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Vector3d weight = svd.solve(measured).head<3>();
  math::check_option(svd.singularValues()[5] >= 1e-3 * svd.singularValues()[0], "poses",
                     svd.singularValues().transpose(),
                     "rotations that separate the load's weight from the bias: a smallest singular "
                     "value of at least 1e-3 of the largest");
  math::check_option(weight.norm() != 0, "poses", 0, "forces with a weight other than 0");
  return weight.normalized();
}

PayloadFit identify_motion(const std::vector<MotionSample>& samples,
                           const IdentificationOptions& options) {
  std::vector<int> all(kPayloadParameterCount);
  for (int i = 0; i < kPayloadParameterCount; ++i) all[i] = i;
  return identify(samples, all, options);
}

}  // namespace palpate::sensing
