#include "core/sensing/linear_tactile.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

TactileInputs tactile_inputs(const BioTac& sample) noexcept {
  TactileInputs inputs;
  inputs << sample.electrodes, sample.pac, sample.pdc;
  return inputs;
}

int feature_count(TactileFeatures features) noexcept {
  return features == TactileFeatures::kCounts ? kTactileInputCount : kMostFeatures;
}

FeatureVector tactile_features(TactileFeatures features, const TactileInputs& inputs) noexcept {
  if (features == TactileFeatures::kCounts) return inputs;
  constexpr int kUsed = kElectrodeCount + 1;  // PAC is zero during a sustained contact
  Eigen::Matrix<double, kUsed, 1> u;
  u << inputs.head<kElectrodeCount>(), inputs[kElectrodeCount + 1];
  const double size = std::max(u.norm(), 1e-9);
  FeatureVector result(kMostFeatures);
  result.head<kUsed>() = u;
  int next = kUsed;
  for (int i = 0; i < kUsed; ++i)
    for (int j = i; j < kUsed; ++j) result[next++] = u[i] * u[j] / size;
  return result;
}

Eigen::Vector3d LinearTactileModel::force(const TactileInputs& inputs) const noexcept {
  Eigen::Vector3d result = offset;
  result.noalias() += matrix * tactile_features(features, inputs);
  return result;
}

Eigen::Vector3d LinearTactileModel::location(const TactileInputs& inputs) const noexcept {
  const double size = std::max(inputs.head<kElectrodeCount>().norm(), 1e-9);
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.noalias() += place * tactile_features(features, inputs);
  return project_on_skin(result / size);
}

namespace {

/// Linear map with offset.
struct Ridge {
  LinearTactileModel::Matrix matrix;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double penalty = 0;
  Eigen::Vector3d cross_validated_rms = Eigen::Vector3d::Zero();

  /// Sum of squared errors per column.
  Eigen::Vector3d squared_error(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const {
    const Eigen::MatrixXd error = (x * matrix.transpose() - y).rowwise() + offset.transpose();
    return error.colwise().squaredNorm().transpose();
  }
};

Ridge ridge(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, double penalty,
            double deviation_floor, bool with_offset) {
  const double n = static_cast<double>(x.rows());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(x.cols());
  Eigen::Vector3d mean_y = Eigen::Vector3d::Zero();
  if (with_offset) {
    mean = x.colwise().mean().transpose();
    mean_y = y.colwise().mean().transpose();
  }
  const Eigen::MatrixXd centred = x.rowwise() - mean.transpose();
  const Eigen::VectorXd deviation =
      (centred.colwise().squaredNorm().transpose() / n).cwiseSqrt().cwiseMax(deviation_floor);
  const Eigen::MatrixXd z = centred * deviation.cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = z.transpose() * z;
  normal.diagonal().array() += penalty * n;
  const Eigen::MatrixXd weights =
      normal.ldlt().solve(z.transpose() * (y.rowwise() - mean_y.transpose()));

  Ridge result;
  result.penalty = penalty;
  result.matrix = weights.transpose() * deviation.cwiseInverse().asDiagonal();
  result.offset = mean_y - result.matrix * mean;
  return result;
}

/// Penalty by cross-validation over blocks of rows.
Ridge best_ridge(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                 const LinearTactileFitOptions& options, double deviation_floor, bool with_offset) {
  const Eigen::Index n = x.rows();
  double least = std::numeric_limits<double>::infinity();
  double best = 0;
  Eigen::Vector3d best_error = Eigen::Vector3d::Zero();
  for (const double penalty : options.penalties) {
    math::check_not_negative(penalty, "penalties");
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (int block = 0; block < options.blocks; ++block) {
      const Eigen::Index begin = n * block / options.blocks;
      const Eigen::Index end = n * (block + 1) / options.blocks;
      Eigen::MatrixXd kept_x(n - (end - begin), x.cols());
      Eigen::MatrixXd kept_y(n - (end - begin), 3);
      kept_x << x.topRows(begin), x.bottomRows(n - end);
      kept_y << y.topRows(begin), y.bottomRows(n - end);
      error +=
          ridge(kept_x, kept_y, penalty, deviation_floor, with_offset)
              .squared_error(x.middleRows(begin, end - begin), y.middleRows(begin, end - begin));
    }
    if (!(error.sum() < least)) continue;
    least = error.sum();
    best = penalty;
    best_error = error;
  }
  Ridge result = ridge(x, y, best, deviation_floor, with_offset);
  result.cross_validated_rms = (best_error / static_cast<double>(n)).cwiseSqrt();
  return result;
}

void check(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
           const LinearTactileFitOptions& options) {
  const Eigen::Index n = inputs.rows();
  math::check_option(inputs.cols() == kTactileInputCount, "inputs", inputs.cols(),
                     std::to_string(kTactileInputCount) + " columns");
  math::check_option(targets.cols() == 3, "targets", targets.cols(), "3 columns");
  math::check_option(targets.rows() == n, "targets", targets.rows(),
                     std::to_string(n) + " rows, as inputs");
  math::check_option(options.blocks >= 2 && n >= 2 * options.blocks, "blocks", options.blocks,
                     "2 to half of the " + std::to_string(n) + " rows");
  math::check_option(!options.penalties.empty(), "penalties", options.penalties.size(),
                     "at least one");
  math::check_positive(options.deviation_floor, "deviation_floor");
  math::check_all_finite(inputs, "inputs");
  math::check_all_finite(targets, "targets");
}

Eigen::MatrixXd feature_rows(const Eigen::MatrixXd& inputs, TactileFeatures features) {
  Eigen::MatrixXd rows(inputs.rows(), feature_count(features));
  for (Eigen::Index i = 0; i < inputs.rows(); ++i)
    rows.row(i) = tactile_features(features, inputs.row(i).transpose()).transpose();
  return rows;
}

}  // namespace

LinearTactileFit fit_linear_tactile(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& forces,
                                    const LinearTactileFitOptions& options) {
  check(inputs, forces, options);
  const Eigen::MatrixXd x = feature_rows(inputs, options.features);
  const Ridge found = best_ridge(x, forces, options, options.deviation_floor, options.with_offset);
  LinearTactileFit fit;
  fit.model.features = options.features;
  fit.model.matrix = found.matrix;
  fit.model.offset = found.offset;
  fit.penalty = found.penalty;
  fit.cross_validated_rms = found.cross_validated_rms;
  fit.training_rms =
      (found.squared_error(x, forces) / static_cast<double>(inputs.rows())).cwiseSqrt();
  return fit;
}

void fit_tactile_place(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& places,
                       const LinearTactileFitOptions& options, LinearTactileModel& model) {
  check(inputs, places, options);
  const Eigen::VectorXd size = inputs.leftCols<kElectrodeCount>().rowwise().norm().cwiseMax(1e-9);
  const Eigen::MatrixXd x = size.cwiseInverse().asDiagonal() * feature_rows(inputs, model.features);
  constexpr double kFloor = 1e-3;  // relative to features of norm one
  model.place = best_ridge(x, places, options, kFloor, false).matrix;
}

}  // namespace palpate::sensing
