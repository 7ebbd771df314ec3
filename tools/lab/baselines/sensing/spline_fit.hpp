#pragma once

#include "tools/lab/baselines/sensing/curve_fit.hpp"

namespace palpate::baselines {

/// Cubic B-spline fitted to a point cloud: A. Jordt and R. Koch, "Direct model-based tracking of 3D
/// object deformations in depth and color video", IJCV 2013, as extended to material parameters
/// with Fugl et al. (Sanchez 2019, Table 2.1 [31], NURBS).
///
/// Consumes: vision, mesh, clamp. No material, no pose of the hand. No probing motions; bars only.
/// Kept: the deformation is a spline function of a few control points, fitted to depth data by
/// analysis by synthesis, here Gauss-Newton; no mechanics. Left out: colour; weights of control
/// points (rational splines); the surface is that of a bar around a line of control points, without
/// twist; the random search (CMA-ES). The line is constrained to keep its length and to bend
/// smoothly, because points do not observe sliding along the line.
class SplineFit final : public CurveFit {
 public:
  struct Options : CurveFit::Options {
    int controls = 7;        // number of free control points, 3 to 12
    double stretch = 0.005;  // standard deviation of the line's stretch
    /// 1/m^2 * 1/m, standard deviation of the change of curvature along the line
    double bend = 200;
  };

  /// Throws std::invalid_argument if the body is not a bar or an option is out of range.
  SplineFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

 private:
  static constexpr int kPlaces = 20;  // number of evaluation points of the line's residuals
  struct Place {
    Eigen::Vector3d position, slope;  // m; derivative with respect to s
  };
  Place at(const Parameters& parameters, double s) const noexcept;
  Eigen::Vector3d control(const Parameters& parameters, int index) const noexcept;
  void draw(const Parameters& parameters, Eigen::Matrix3Xd& shape) const noexcept override;
  void judge(const Parameters& parameters, Own& residuals) const noexcept override;

  int controls_;
  double stretch_, bend_, spacing_;
};

}  // namespace palpate::baselines
