#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Elliptic Fourier coefficients of a contour of ordered material points, m: a line as a few smooth
/// numbers, as in Navarro-Alarcon and Liu (2018) and Zhu et al. (2018). With s the arc length along
/// the polygon of the points at rest and l its total,
///   closed: x(s) = a_0 + sum_k a_k cos(2 pi k s / l) + b_k sin(2 pi k s / l),
///   open:   x(s) = a_0 + sum_k a_k cos(pi k s / l)   (the contour traversed forth and back),
/// k = 1 to `harmonics`, fitted to the points by least squares, one set for each of `components`.
/// The last point of a closed contour is joined to its first, which is not repeated.
///
/// Value, target, error: a_0, a_1, b_1, a_2, b_2, ... (open: a_0, a_1, a_2, ...) of the first
/// component, then of the next. The amplitudes are expressed in O and not normalised by size,
/// direction or starting point, since these are to be controlled and the material points fix the
/// starting point. Because s refers to the rest shape, the coefficients are linear in the
/// positions, never degenerate, with a constant Jacobian.
class FourierContourFeature : public MaterialFeature {
 public:
  static constexpr int kMostPoints = 64;

  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // in O, m; up to kMostPoints
    int harmonics = 3;                         // at least 1
    bool closed = true;
    /// Distinct entries of 0 = x, 1 = y, 2 = z; those of the contour's plane.
    std::vector<int> components{0, 1, 2};
  };

  /// Throws std::invalid_argument if a point is not on the mesh, two points are nearer than
  /// kNearestPair, components are not different axes, or the points are too few or too unevenly
  /// spaced to determine the coefficients.
  FourierContourFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "fourier_contour"; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;

 private:
  std::vector<int> components_;
  Eigen::MatrixXd fit_;  // maps one component of the points to the coefficients of that component
};

}  // namespace palpate::shape
