#pragma once

#include "tools/lab/baselines/sensing/bar_axis.hpp"
#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Shape with a few parameters, fitted to point clouds: one Gauss-Newton step per cloud with the
/// points' distances along the surface normal and residuals of the shape itself. Numerical
/// derivatives. Nothing allocates after construction.
class CurveFit : public CloudEstimator {
 public:
  static constexpr int kMost = 36;     // maximum number of parameters
  static constexpr int kMostOwn = 80;  // maximum number of residuals of the shape itself
  using Parameters = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Own = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostOwn, 1>;

  struct Options : CloudEstimator::Options {
    /// m, standard deviation of a point's distance from the surface: weighs points against the
    /// prior
    double deviation = 1e-3;
    double memory = 1;   // weight of the last parameters in units of clouds; >= 0
    double step = 1e-5;  // increment of a scaled parameter for its derivative
  };

  const Parameters& parameters() const noexcept { return parameters_; }

 protected:
  /// Throws std::invalid_argument if an option is out of range or there are too many parameters.
  CurveFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options,
           int parameters, int own);

  /// Node positions of the mesh in O, m, for parameters of order one.
  virtual void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept = 0;
  /// Residuals in addition to those of the points, each divided by its standard deviation.
  virtual void judge(const Parameters& parameters, Own& residuals) const noexcept = 0;
  const BarAxis& bar() const noexcept { return bar_; }
  /// Initial parameters; call from the constructor of the derived class.
  void begin_from(const Parameters& parameters) noexcept;

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;

  Options options_;
  BarAxis bar_;
  Parameters parameters_, first_;
  Own own_, own_moved_;
  Eigen::Matrix3Xd shape_, moved_;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  Square information_;
  Eigen::Matrix<double, kMost, estimation::ObservationInput::kMostPoints + kMostOwn> slopes_;
};

}  // namespace palpate::baselines
