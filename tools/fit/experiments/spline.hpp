#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// Natural cubic spline, linear outside its ends.
class Spline {
 public:
  /// x rising, at least two.
  Spline(Eigen::VectorXd x, Eigen::VectorXd y);

  double value(double x) const { return at(x).value; }
  double slope(double x) const { return at(x).slope; }

  struct Point {
    double value = 0;
    double slope = 0;
  };
  Point at(double x) const;

 private:
  Eigen::VectorXd x_, y_, bend_;  // second derivatives
};

}  // namespace palpate::fit
