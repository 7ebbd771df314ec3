#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::recordings {

/// y = matrix * x + offset, including the standardisation of both.
struct Ridge {
  Eigen::MatrixXd matrix;   // outputs x inputs
  Eigen::VectorXd offset;   // outputs
  Eigen::VectorXd penalty;  // outputs: the selected penalty, on standardised weights, per row

  Eigen::MatrixXd predict(const Eigen::MatrixXd& x) const {
    return (x * matrix.transpose()).rowwise() + offset.transpose();
  }
};

/// Ridge regression, for each output with the penalty of the lowest prediction error when each of
/// `blocks` runs of consecutive rows is left out once. x: n x inputs, y: n x outputs. Throws
/// std::invalid_argument if there are fewer than two rows per block.
Ridge fit_ridge(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                const std::vector<double>& penalties, int blocks = 20);

}  // namespace palpate::recordings
