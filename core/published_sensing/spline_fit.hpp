#pragma once

#include "core/published_sensing/curve_fit.hpp"

namespace palpate::published_sensing {

/// A cubic B-spline fitted to a cloud: A. Jordt and R. Koch, "Direct model-based tracking of 3D
/// object deformations in depth and color video", IJCV 2013, as extended to material parameters
/// with Fugl et al. (thesis [31], NURBS).
///
/// Consumes: vision, mesh, clamp. No material, not the hand. No probes; bars alone.
/// Kept: the deformation is a spline function of a few control points, which are fitted to depth by
/// analysis and synthesis, here Gauss-Newton; nothing mechanical.
/// Left out: colour; weights of control points (rational splines); the surface is that of a bar
/// about a line of control points, which does not twist; the search over random samples (CMA-ES).
/// The line is asked to keep its length and to bend smoothly, since points do not show how it
/// slides along itself.
class SplineFit final : public CurveFit {
 public:
  struct Options : CurveFit::Options {
    int controls = 7;        // control points that are free, from 3 to 12
    double stretch = 0.005;  // deviation of the line's stretch
    double bend = 200;       // 1/m^2 * 1/m, deviation of the change of curvature along the line
  };

  /// Throws std::invalid_argument where the body is no bar, or an option is out of range.
  SplineFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

 private:
  static constexpr int kPlaces = 20;  // at which the line is judged
  struct Place {
    Eigen::Vector3d position, slope;  // m; by s
  };
  Place at(const Parameters& parameters, double s) const noexcept;
  Eigen::Vector3d control(const Parameters& parameters, int index) const noexcept;
  void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept override;
  void judge(const Parameters& parameters, Own& residuals) const noexcept override;

  int controls_;
  double stretch_, bend_, spacing_;
};

}  // namespace palpate::published_sensing
