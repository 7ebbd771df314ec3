#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace palpate::fit {

/// A parameter to identify. Experiments that name the same parameter share it; a recording's own
/// parameter has the recording's name as prefix ("compression_1.contact_offset").
struct Parameter {
  std::string name;
  std::string unit;  // SI, "" for a ratio
  double start = 0;  // start of the search
  double lower = 0;  // bounds, inclusive; lower == upper: known, not identified
  double upper = 0;
  bool is_logarithmic = false;  // identified as its logarithm: needs lower > 0
};

/// One measured quantity along a recording, SI units.
struct Series {
  std::string quantity;           // "force"
  std::string unit;               // "N"
  std::string abscissa;           // "displacement", abscissa of the plot
  std::string abscissa_unit;      // "m"
  Eigen::VectorXd x = {};         // abscissa by sample
  Eigen::VectorXd measured = {};  // by sample
  double deviation = 1;           // standard deviation of one sample: residuals are divided by it
  std::vector<bool> is_held_out = {};  // by sample: predicted, not fitted; empty: none
};

/// Abscissa of a sample; its number where the series has none.
inline double abscissa_of(const Series& series, Eigen::Index sample) {
  return series.x.size() == series.measured.size() ? series.x[sample] : static_cast<double>(sample);
}

/// A quantity by which recording and prediction are compared in addition to the residuals: a
/// period, or the error of a prediction that other models make as well.
struct Finding {
  std::string what;     // "period"
  std::string unit;     // SI
  double measured = 0;  // or the value for comparison
  double predicted = 0;
  double allowed = 0;     // upper bound of |predicted - measured|; 0: none
  bool is_bound = false;  // `measured` is the error of another model: lower is better
};

/// A recording together with the mechanical model that predicts it from parameters. Constant after
/// construction, so that threads may share it.
class Experiment {
 public:
  virtual ~Experiment() = default;

  const std::string& name() const { return name_; }
  const std::vector<Series>& series() const { return series_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  /// Their starts.
  Eigen::VectorXd start() const {
    Eigen::VectorXd values(parameters_.size());
    for (std::size_t k = 0; k < parameters_.size(); ++k) values[k] = parameters_[k].start;
    return values;
  }
  /// Samples of all series: the rows of a prediction.
  Eigen::Index sample_count() const {
    Eigen::Index count = 0;
    for (const Series& series : series_) count += series.measured.size();
    return count;
  }

  /// Prediction of the concatenated series and, if `jacobian` is given, its derivatives by the
  /// parameters (rows as `prediction`, columns as parameters(); by the parameter itself, not by its
  /// logarithm). False if there is no equilibrium with these parameters.
  virtual bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
                       Eigen::MatrixXd* jacobian) const = 0;

  /// Further results of the parameters; empty if there are none or there is no equilibrium.
  virtual std::vector<Finding> findings(const Eigen::VectorXd& /*parameters*/) const { return {}; }

  /// The material's name in core/solid/strain_energy.hpp; "linear" is the co-rotational one of
  /// `young_modulus` and `poisson_ratio`. Another name if no solid is fitted.
  virtual std::string material() const { return "linear"; }

  /// Smallest and largest strain of the fitted samples (compression negative), the range of
  /// validity of the result; both 0 if unknown.
  virtual std::array<double, 2> strain_range() const { return {0, 0}; }

 protected:
  explicit Experiment(std::string name = "") : name_(std::move(name)) {}

  std::string name_;
  std::vector<Series> series_;
  std::vector<Parameter> parameters_;
};

}  // namespace palpate::fit
