#pragma once

#include <Eigen/Core>
#include <atomic>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// A plan's settings of a parameter, which override those of the experiments.
struct ParameterChange {
  std::optional<double> start, lower, upper, known;
};

/// An experiment in a problem, and its parameters with a different name there.
struct Member {
  std::shared_ptr<const Experiment> experiment;
  std::vector<std::string> own;  // shared by the experiment, own parameter of this recording here
  std::vector<std::string> shared;  // "contact_offset": the recording's own, shared here
};

/// A series of a problem's.
struct SeriesPlace {
  int member = 0;
  int series = 0;        // of the experiment
  Eigen::Index row = 0;  // start in the experiment's prediction
};

/// Samples of all members that are fitted, as residuals of free parameters.
///
/// The free parameters are represented by coordinates: the logarithm of logarithmic ones, the value
/// of the others divided by half of the allowed range, so that 1 is a large change of any.
class Problem {
 public:
  /// Throws std::invalid_argument if parameters of one name contradict each other, a change names
  /// no parameter, or nothing is left to identify or to fit.
  Problem(std::vector<Member> members, const std::map<std::string, ParameterChange>& changes);

  const std::vector<Member>& members() const { return members_; }
  /// Of all members, each name once; `start` as in the plan.
  const std::vector<Parameter>& parameters() const { return parameters_; }
  /// The free parameters, by index in parameters().
  const std::vector<int>& free() const { return free_; }
  const std::vector<SeriesPlace>& series() const { return series_; }
  const Series& series_at(std::size_t place) const;
  bool is_fitted(std::size_t place, Eigen::Index sample) const;
  Eigen::Index fitted_count(std::size_t place) const { return fitted_[place]; }
  Eigen::Index fitted_count() const;

  /// Standard deviation of a sample by series(): initially as given by the experiment.
  const std::vector<double>& deviations() const { return deviations_; }
  void set_deviations(std::vector<double> deviations) { deviations_ = std::move(deviations); }

  /// Coordinates of the free parameters, within limits.
  Eigen::VectorXd start() const { return coordinates(&Parameter::start); }
  Eigen::VectorXd lower() const { return coordinates(&Parameter::lower); }
  Eigen::VectorXd upper() const { return coordinates(&Parameter::upper); }
  double to_coordinate(int parameter, double value) const;
  double to_value(int parameter, double coordinate) const;
  /// dvalue/dcoordinate of a parameter.
  double slope(int parameter, double value) const;
  /// Values of all parameters.
  Eigen::VectorXd values(const Eigen::VectorXd& coordinates) const;

  /// Of one member, all samples: prediction, and by free coordinates. False without equilibrium.
  bool predict(int member, const Eigen::VectorXd& coordinates, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const;

  /// Of one member, fitted samples: (prediction - measured) / deviation.
  bool residuals(int member, const Eigen::VectorXd& coordinates, Eigen::VectorXd& residuals,
                 Eigen::MatrixXd* jacobian) const;
  Eigen::Index residual_count(int member) const;

  /// Derivatives by central differences instead of the experiments' own.
  bool is_numeric = false;

  /// Number of evaluations of experiments: for predictions alone, and with derivatives.
  struct Count {
    long predictions = 0;
    long jacobians = 0;
  };
  Count count() const { return {predictions_.load(), jacobians_.load()}; }

 private:
  std::vector<Parameter>::iterator find(const std::string& name);
  Eigen::VectorXd coordinates(double Parameter::*value) const;
  void add_parameter(const Parameter& parameter);
  void change(const std::map<std::string, ParameterChange>& changes);
  bool ask(int member, const Eigen::VectorXd& values, Eigen::VectorXd& prediction,
           Eigen::MatrixXd* jacobian) const;
  bool differentiate(int member, const Eigen::VectorXd& coordinates,
                     Eigen::MatrixXd& jacobian) const;

  std::vector<Member> members_;
  std::vector<Parameter> parameters_;
  std::vector<std::vector<int>> places_;  // by member, index of its parameters in parameters_
  std::vector<int> free_;
  std::vector<SeriesPlace> series_;
  std::vector<Eigen::Index> fitted_;  // by series
  std::vector<double> deviations_;
  mutable std::atomic<long> predictions_{0};
  mutable std::atomic<long> jacobians_{0};
};

}  // namespace palpate::fit
