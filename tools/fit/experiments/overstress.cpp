#include "tools/fit/experiments/overstress.hpp"

#include <cmath>

namespace palpate::fit {

StressHistory relaxing_part(const StressHistory& elastic, const Eigen::VectorXd& time, double ratio,
                            double relaxation_time, Eigen::Index ratio_column,
                            Eigen::Index time_column) {
  const Eigen::Index n = elastic.stress.size();
  StressHistory q;
  q.stress.setZero(n);
  q.by_parameter.setZero(n, elastic.by_parameter.cols());
  for (Eigen::Index i = 1; i < n; ++i) {
    const double h = time[i] - time[i - 1], tau = relaxation_time;
    const double a = std::exp(-h / tau), b = -std::expm1(-h / tau) * tau / h;
    const double a_tau = a * h / (tau * tau), b_tau = b / tau - a / tau;
    const double change = elastic.stress[i] - elastic.stress[i - 1];
    q.stress[i] = a * q.stress[i - 1] + ratio * b * change;
    q.by_parameter.row(i) =
        a * q.by_parameter.row(i - 1) +
        ratio * b * (elastic.by_parameter.row(i) - elastic.by_parameter.row(i - 1));
    q.by_parameter(i, ratio_column) += b * change;
    q.by_parameter(i, time_column) += a_tau * q.stress[i - 1] + ratio * b_tau * change;
  }
  return q;
}

}  // namespace palpate::fit
