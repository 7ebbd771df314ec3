#pragma once

#include "core/published_sensing/bar_axis.hpp"
#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// A shape with a few parameters, fitted to clouds: one step of Gauss and Newton for each cloud,
/// with the points' distances along the normal of the surface and what the shape itself asks for.
/// Derivatives are by differences. Allocates nothing after construction.
class CurveFit : public CloudEstimator {
 public:
  static constexpr int kMost = 36;     // parameters
  static constexpr int kMostOwn = 80;  // residuals of the shape itself
  using Parameters = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Own = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostOwn, 1>;

  struct Options : CloudEstimator::Options {
    double deviation = 1e-3;  // m, of a point from the surface: weighs points against the prior
    double memory = 1;        // of the last parameters, as so many clouds' worth; >= 0
    double step = 1e-5;       // of a scaled parameter, for its derivative
  };

  const Parameters& parameters() const noexcept { return parameters_; }

 protected:
  /// Throws std::invalid_argument where an option is out of range or there are too many parameters.
  CurveFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options,
           int parameters, int own);

  /// Of the parameters, which are of order one: nodes of the mesh in O, m.
  virtual void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept = 0;
  /// Residuals beside the points', each over its deviation.
  virtual void judge(const Parameters& parameters, Own& residuals) const noexcept = 0;
  const BarAxis& bar() const noexcept { return bar_; }
  /// Where the fit begins; to be called by the constructor of what draws.
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

}  // namespace palpate::published_sensing
