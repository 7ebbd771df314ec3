#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/math/random.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// y = f(parameters, x) with derivatives, at given abscissas: the simplest possible experiment.
class CurveExperiment final : public Experiment {
 public:
  using Curve = std::function<double(const Eigen::VectorXd& p, double x, Eigen::VectorXd* by)>;

  CurveExperiment(std::string name, std::vector<Parameter> parameters, Curve curve)
      : Experiment(std::move(name)), curve_(std::move(curve)) {
    parameters_ = std::move(parameters);
  }

  /// Measured with white noise at `count` abscissas from 0 to 1; the last `held` are held out.
  void measure(const Eigen::VectorXd& truth, int count, double noise, math::Random& random,
               int held = 0) {
    Series series{"height", "m", "place", ""};
    series.deviation = noise > 0 ? noise : 1;
    series.x.setLinSpaced(count, 0, 1);
    series.measured.resize(count);
    series.is_held_out.assign(static_cast<std::size_t>(count), false);
    for (int i = 0; i < count; ++i) {
      series.measured[i] = curve_(truth, series.x[i], nullptr) + noise * random.normal();
      series.is_held_out[static_cast<std::size_t>(i)] = i >= count - held;
    }
    series_ = {series};
  }
  std::vector<Series>& mutable_series() { return series_; }

  bool predict(const Eigen::VectorXd& p, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    const Eigen::VectorXd& x = series_.front().x;
    prediction.resize(x.size());
    if (jacobian) jacobian->resize(x.size(), p.size());
    Eigen::VectorXd by(p.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      prediction[i] = curve_(p, x[i], jacobian ? &by : nullptr);
      if (jacobian) jacobian->row(i) = by.transpose();
    }
    return prediction.allFinite();
  }

 private:
  Curve curve_;
};

/// a exp(-x / b).
inline double decay(const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
  const double e = std::exp(-x / p[1]);
  if (by) *by << e, p[0] * e * x / (p[1] * p[1]);
  return p[0] * e;
}

inline std::vector<Parameter> decay_parameters() {
  return {{"height", "m", 1, 1e-3, 1e3, true}, {"length", "m", 1, 1e-3, 1e3, true}};
}

}  // namespace palpate::fit
