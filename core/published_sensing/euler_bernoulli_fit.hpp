#pragma once

#include "core/published_sensing/curve_fit.hpp"

namespace palpate::published_sensing {

/// A beam after Euler and Bernoulli, fitted to a cloud: A. Fugl, A. Jordt, H. Petersen, M.
/// Willatzen and R. Koch, "Simultaneous estimation of material properties and pose for deformable
/// objects from depth and color images", DAGM/OAGM 2012 (thesis [27]).
///
/// Consumes: vision, mesh, clamp, density, gravity. Not E, which it finds; not the hand. No probes;
/// bars alone.
/// Kept: curvature is the bending moment over E I, the moment that of a distributed weight and of
/// end loads; the sag of the weight gives E (told as `log E`); the whole is fitted to depth data.
/// Beyond the paper: bending in both planes, and the line is drawn by integrating curvature, so
/// that it does not stretch however far it bends. Left out: colour; the paper's plane strip becomes
/// a bar that neither twists nor shears. What the hand holds is straight.
///
/// Parameters: curvature in both planes at the clamp and at the hand, 1/m over 5; weight over
/// stiffness, as the logarithm of its ratio to what E of the configuration gives.
class EulerBernoulliFit final : public CurveFit {
 public:
  struct Options : CurveFit::Options {
    double log_young_deviation = 1;  // prior, about E of the configuration
  };

  /// Throws std::invalid_argument where the body is no bar, or an option is out of range.
  EulerBernoulliFit(const elasticity::Body& body, const mesh::Surface& surface,
                    const Options& options);

  double young_modulus() const noexcept;  // Pa

 private:
  static constexpr int kSteps = 24;  // of the integration along the bar
  void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept override;
  void judge(const Parameters& parameters, Own& residuals) const noexcept override;
  void tell(estimation::Estimate& estimate) noexcept override;

  double nominal_young_, log_deviation_;
  double end_deviation_;    // of the parameters of end loads
  Eigen::Vector2d weight_;  // curvature by weight towards across(0), (1), 1/m by (L - s)^2 in m^2
};

}  // namespace palpate::published_sensing
