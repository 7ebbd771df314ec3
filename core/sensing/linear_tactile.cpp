#include "core/sensing/linear_tactile.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <stdexcept>

namespace palpate::sensing {

TactileInputs tactile_inputs(const BioTac& sample) noexcept {
  TactileInputs inputs;
  inputs << sample.electrodes, sample.pac, sample.pdc;
  return inputs;
}

namespace {

LinearTactileModel ridge(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& forces,
                         double penalty, const LinearTactileFitOptions& options) {
  const double n = static_cast<double>(inputs.rows());
  TactileInputs mean = TactileInputs::Zero();
  Eigen::Vector3d mean_force = Eigen::Vector3d::Zero();
  if (options.with_offset) {
    mean = inputs.colwise().mean().transpose();
    mean_force = forces.colwise().mean().transpose();
  }
  const Eigen::MatrixXd centred = inputs.rowwise() - mean.transpose();
  const TactileInputs deviation = (centred.colwise().squaredNorm().transpose() / n)
                                      .cwiseSqrt()
                                      .cwiseMax(options.deviation_floor);
  const Eigen::MatrixXd z = centred * deviation.cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = z.transpose() * z;
  normal.diagonal().array() += penalty * n;
  const Eigen::MatrixXd weights =
      normal.ldlt().solve(z.transpose() * (forces.rowwise() - mean_force.transpose()));

  LinearTactileModel model;
  model.matrix = weights.transpose() * deviation.cwiseInverse().asDiagonal();
  model.offset = mean_force - model.matrix * mean;
  return model;
}

/// Sum of squared errors per axis.
Eigen::Vector3d squared_error(const LinearTactileModel& model, const Eigen::MatrixXd& inputs,
                              const Eigen::MatrixXd& forces) {
  const Eigen::MatrixXd error =
      (inputs * model.matrix.transpose() - forces).rowwise() + model.offset.transpose();
  return error.colwise().squaredNorm().transpose();
}

}  // namespace

LinearTactileFit fit_linear_tactile(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& forces,
                                    const LinearTactileFitOptions& options) {
  const Eigen::Index n = inputs.rows();
  if (inputs.cols() != kTactileInputCount || forces.cols() != 3 || forces.rows() != n)
    throw std::invalid_argument("tactile fit: inputs must be n x 21 and forces n x 3");
  if (options.blocks < 2 || n < 2 * options.blocks)
    throw std::invalid_argument("tactile fit: needs two blocks or more, of two rows or more");
  if (options.penalties.empty() || !(options.deviation_floor > 0))
    throw std::invalid_argument("tactile fit: needs a penalty and a positive deviation_floor");
  if (!inputs.allFinite() || !forces.allFinite())
    throw std::invalid_argument("tactile fit: a number is not finite");

  LinearTactileFit fit;
  double least = std::numeric_limits<double>::infinity();
  for (const double penalty : options.penalties) {
    if (!(penalty >= 0)) throw std::invalid_argument("tactile fit: a penalty is negative");
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (int block = 0; block < options.blocks; ++block) {
      const Eigen::Index begin = n * block / options.blocks;
      const Eigen::Index end = n * (block + 1) / options.blocks;
      Eigen::MatrixXd kept_inputs(n - (end - begin), kTactileInputCount);
      Eigen::MatrixXd kept_forces(n - (end - begin), 3);
      kept_inputs << inputs.topRows(begin), inputs.bottomRows(n - end);
      kept_forces << forces.topRows(begin), forces.bottomRows(n - end);
      error += squared_error(ridge(kept_inputs, kept_forces, penalty, options),
                             inputs.middleRows(begin, end - begin),
                             forces.middleRows(begin, end - begin));
    }
    if (error.sum() < least) {
      least = error.sum();
      fit.penalty = penalty;
      fit.cross_validated_rms = (error / static_cast<double>(n)).cwiseSqrt();
    }
  }
  fit.model = ridge(inputs, forces, fit.penalty, options);
  fit.training_rms =
      (squared_error(fit.model, inputs, forces) / static_cast<double>(n)).cwiseSqrt();
  return fit;
}

}  // namespace palpate::sensing
