#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace palpate::fit {

/// What is sought. Experiments that name the same parameter share it; one of a recording's own
/// carries the recording's name in front ("compression_1.contact_offset").
struct Parameter {
  std::string name;
  std::string unit;  // SI, "" for a ratio
  double start = 0;  // where the search begins
  double lower = 0;  // allowed, ends included; lower == upper: known, not sought
  double upper = 0;
  bool is_logarithmic = false;  // sought as its logarithm: needs lower > 0
};

/// One measured quantity along a recording, SI units.
struct Series {
  std::string quantity;           // "force"
  std::string unit;               // "N"
  std::string abscissa;           // "displacement", what the plot has on its x axis
  std::string abscissa_unit;      // "m"
  Eigen::VectorXd x;              // abscissa by sample
  Eigen::VectorXd measured;       // by sample
  double deviation = 1;           // of one sample: residuals are divided by it
  std::vector<bool> is_held_out;  // by sample: predicted, not fitted; empty: none
};

/// A quantity that a recording and its prediction are compared by beside their residuals: a period,
/// an error of a prediction that others make as well.
struct Finding {
  std::string what;     // "period"
  std::string unit;     // SI
  double measured = 0;  // or what it has to be compared with
  double predicted = 0;
  double allowed = 0;     // greatest |predicted - measured|; 0: nothing is asked for
  bool is_bound = false;  // `measured` is what others reach: less is asked for
};

/// A recording together with the mechanics that predicts it from parameters. Constant after
/// construction, so that threads may share it.
class Experiment {
 public:
  virtual ~Experiment() = default;

  virtual const std::string& name() const = 0;
  virtual const std::vector<Series>& series() const = 0;
  virtual const std::vector<Parameter>& parameters() const = 0;

  /// What the series would be, behind each other, and where `jacobian` is given its derivatives by
  /// the parameters (rows as `prediction`, columns as parameters(); by the parameter itself, not by
  /// its logarithm). False where there is no equilibrium with these parameters.
  virtual bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
                       Eigen::MatrixXd* jacobian) const = 0;

  /// What else the parameters come to; empty where there is nothing to say or no equilibrium.
  virtual std::vector<Finding> findings(const Eigen::VectorXd& /*parameters*/) const { return {}; }

  /// The material's name among core/solid/strain_energy.hpp's; "linear" is the co-rotational
  /// one of `young_modulus` and `poisson_ratio`. Another name where no solid is fitted.
  virtual std::string material() const { return "linear"; }

  /// Least and greatest strain of what is fitted (compression negative), which the result holds
  /// for; both 0 where nobody knows.
  virtual std::array<double, 2> strain_range() const { return {0, 0}; }
};

}  // namespace palpate::fit
