#pragma once

#include "tools/lab/baselines/sensing/curve_fit.hpp"

namespace palpate::baselines {

/// Euler-Bernoulli beam fitted to a point cloud: A. Fugl, A. Jordt, H. Petersen, M. Willatzen and
/// R. Koch, "Simultaneous estimation of material properties and pose for deformable objects from
/// depth and color images", DAGM/OAGM 2012 (Sanchez 2019, Table 2.1 [27]).
///
/// Consumes: vision, mesh, clamp, density, gravity. Not E, which is estimated; no pose of the hand.
/// No probing motions; bars only. Kept: curvature equals bending moment divided by E I, the moment
/// resulting from distributed weight and end loads; the sag under weight determines E (reported as
/// `log E`); everything is fitted to depth data. Beyond the paper: bending in both planes, and the
/// line is obtained by integrating the curvature, so that it does not stretch under large bending.
/// Left out: colour; the paper's planar strip becomes a bar without twist and shear. The grasped
/// part is straight.
///
/// Parameters: curvature in both planes at the clamp and at the hand, 1/m divided by 5; weight
/// divided by stiffness, as the logarithm of its ratio to the value for the configured E.
class EulerBernoulliFit final : public CurveFit {
 public:
  struct Options : CurveFit::Options {
    double log_young_deviation = 1;  // prior standard deviation about the configured E
  };

  /// Throws std::invalid_argument if the body is not a bar or an option is out of range.
  EulerBernoulliFit(const elasticity::Body& body, const mesh::Surface& surface,
                    const Options& options);

  double young_modulus() const noexcept;  // Pa

 private:
  static constexpr int kSteps = 24;  // integration steps along the bar
  void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept override;
  void judge(const Parameters& parameters, Own& residuals) const noexcept override;
  void report(estimation::Estimate& estimate) noexcept override;

  double nominal_young_, log_deviation_;
  double end_deviation_;    // standard deviation of the parameters of end loads
  Eigen::Vector2d weight_;  // curvature by weight towards across(0), (1), 1/m per (L - s)^2 in m^2
};

}  // namespace palpate::baselines
