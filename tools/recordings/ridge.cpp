#include "tools/recordings/ridge.hpp"

#include <Eigen/Cholesky>
#include <stdexcept>
#include <string>

namespace palpate::recordings {
namespace {

/// Sums over rows that suffice for a ridge regression with any penalty.
struct Moments {
  double count = 0;
  Eigen::VectorXd x, y;    // sums
  Eigen::MatrixXd xx, xy;  // of products

  Moments(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b)
      : count(static_cast<double>(a.rows())),
        x(a.colwise().sum().transpose()),
        y(b.colwise().sum().transpose()),
        xx(a.transpose() * a),
        xy(a.transpose() * b) {}

  Moments without(const Moments& part) const {
    Moments rest = *this;
    rest.count -= part.count;
    rest.x -= part.x;
    rest.y -= part.y;
    rest.xx -= part.xx;
    rest.xy -= part.xy;
    return rest;
  }

  Ridge solve(double penalty) const {
    const Eigen::VectorXd mean_x = x / count;
    const Eigen::VectorXd mean_y = y / count;
    Eigen::MatrixXd normal = xx - count * mean_x * mean_x.transpose();
    normal.diagonal().array() += penalty * count;
    Ridge ridge;
    ridge.matrix = normal.ldlt().solve(xy - count * mean_x * mean_y.transpose()).transpose();
    ridge.offset = mean_y - ridge.matrix * mean_x;
    return ridge;
  }
};

}  // namespace

Ridge fit_ridge(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                const std::vector<double>& penalties, int blocks) {
  const Eigen::Index n = x.rows();
  if (y.rows() != n || n < 2 * blocks)
    throw std::invalid_argument("ridge: too few rows of training data (" + std::to_string(n) + ")");
  const Moments all(x, y);
  const auto choices = static_cast<Eigen::Index>(penalties.size());
  Eigen::MatrixXd error = Eigen::MatrixXd::Zero(choices, y.cols());
  for (int block = 0; block < blocks; ++block) {
    const Eigen::Index begin = n * block / blocks;
    const Eigen::Index size = n * (block + 1) / blocks - begin;
    const Eigen::MatrixXd left_x = x.middleRows(begin, size);
    const Eigen::MatrixXd left_y = y.middleRows(begin, size);
    const Moments rest = all.without(Moments(left_x, left_y));
    for (Eigen::Index k = 0; k < choices; ++k)
      error.row(k) += (rest.solve(penalties[k]).predict(left_x) - left_y).colwise().squaredNorm();
  }
  Ridge ridge{Eigen::MatrixXd(y.cols(), x.cols()), Eigen::VectorXd(y.cols()),
              Eigen::VectorXd(y.cols())};
  for (Eigen::Index output = 0; output < y.cols(); ++output) {
    Eigen::Index best = 0;
    error.col(output).minCoeff(&best);
    const double penalty = penalties.at(static_cast<std::size_t>(best));
    const Ridge answer = all.solve(penalty);
    ridge.matrix.row(output) = answer.matrix.row(output);
    ridge.offset[output] = answer.offset[output];
    ridge.penalty[output] = penalty;
  }
  return ridge;
}

}  // namespace palpate::recordings
