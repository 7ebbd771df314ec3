#pragma once

#include <gtest/gtest.h>

#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Column by column, largest difference between an experiment's derivatives and Richardson's
/// extrapolation of central differences, relative to the column's size. `steps`: by parameter.
inline Eigen::VectorXd gradient_errors(const Experiment& experiment, const Eigen::VectorXd& at,
                                       const Eigen::VectorXd& steps) {
  Eigen::VectorXd value, ahead, behind, errors(at.size());
  Eigen::MatrixXd jacobian;
  EXPECT_TRUE(experiment.predict(at, value, &jacobian));
  EXPECT_EQ(jacobian.rows(), value.size());
  EXPECT_EQ(jacobian.cols(), at.size());
  for (Eigen::Index p = 0; p < at.size(); ++p) {
    const auto central = [&](double h) {
      Eigen::VectorXd x = at;
      x[p] = at[p] + h;
      EXPECT_TRUE(experiment.predict(x, ahead, nullptr));
      x[p] = at[p] - h;
      EXPECT_TRUE(experiment.predict(x, behind, nullptr));
      return Eigen::VectorXd((ahead - behind) / (2 * h));
    };
    const Eigen::VectorXd slope = (4 * central(steps[p] / 2) - central(steps[p])) / 3;
    EXPECT_GT(slope.cwiseAbs().maxCoeff(), 0) << "parameter " << p << " moves nothing";
    errors[p] = (jacobian.col(p) - slope).cwiseAbs().maxCoeff() / slope.cwiseAbs().maxCoeff();
  }
  return errors;
}

}  // namespace palpate::fit
