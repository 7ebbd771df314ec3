#include "tools/recordings/errors.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::recordings {
namespace {

double quantile(std::vector<double> values, double part) {
  const auto place = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[place];
}

}  // namespace

Errors measure_errors(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth,
                      const std::vector<ColumnGroup>& outputs) {
  if (predicted.rows() != truth.rows() || predicted.cols() != truth.cols())
    throw std::invalid_argument("errors: predictions and truth differ in size");
  if (truth.rows() == 0) throw std::invalid_argument("errors: there is no row to score");
  const double n = static_cast<double>(truth.rows());
  const Eigen::MatrixXd error = predicted - truth;
  Errors result;
  result.rows = truth.rows();
  result.rms = (error.colwise().squaredNorm() / n).cwiseSqrt().transpose();
  result.mean_absolute = error.cwiseAbs().colwise().mean().transpose();
  result.correlation.setZero(truth.cols());
  for (Eigen::Index i = 0; i < truth.cols(); ++i) {
    const Eigen::VectorXd a = predicted.col(i).array() - predicted.col(i).mean();
    const Eigen::VectorXd b = truth.col(i).array() - truth.col(i).mean();
    const double size = a.norm() * b.norm();
    if (size > 0) result.correlation[i] = a.dot(b) / size;
  }
  Eigen::Index first = 0;
  for (const ColumnGroup& group : outputs) {
    const auto count = static_cast<Eigen::Index>(group.columns.size());
    result.norms.push_back(error.middleCols(first, count).norm() / std::sqrt(n));
    const Eigen::VectorXd longer = predicted.middleCols(first, count).rowwise().norm() -
                                   truth.middleCols(first, count).rowwise().norm();
    result.lengths.push_back(longer.norm() / std::sqrt(n));
    std::vector<double> angles;
    if (group.is_direction)
      for (Eigen::Index k = 0; k < truth.rows(); ++k) {
        const Eigen::VectorXd a = predicted.row(k).segment(first, count).transpose();
        const Eigen::VectorXd b = truth.row(k).segment(first, count).transpose();
        const double size = a.norm() * b.norm();
        angles.push_back(size > 0 ? std::acos(std::clamp(a.dot(b) / size, -1.0, 1.0)) : M_PI);
      }
    result.median_angle.push_back(angles.empty() ? 0 : quantile(angles, 0.5));
    result.angle_90.push_back(angles.empty() ? 0 : quantile(angles, 0.9));
    first += count;
  }
  return result;
}

}  // namespace palpate::recordings
