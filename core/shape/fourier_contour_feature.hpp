#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Elliptic Fourier coefficients of a contour of material points in their order, m: the line as a
/// few smooth numbers, as Navarro-Alarcon and Liu (2018) and Zhu et al. (2018) steer it. With s the
/// length along the polygon of the points at rest and l the whole of it,
///   closed: x(s) = a_0 + sum_k a_k cos(2 pi k s / l) + b_k sin(2 pi k s / l),
///   open:   x(s) = a_0 + sum_k a_k cos(pi k s / l)   (the contour there and back again),
/// k = 1 to `harmonics`, fitted by least squares to the points, one set for each of `components`.
/// A closed contour's last point is joined to its first, which is not repeated.
///
/// Value, target, error: a_0, a_1, b_1, a_2, b_2, ... (open: a_0, a_1, a_2, ...) of the first
/// component, then the next. They are amplitudes in O and not normalised by size, direction or
/// start: these are to be controlled, and material points fix where the contour starts. As s is
/// of the rest shape, they are linear in the positions, never degenerate, with a constant Jacobian.
class FourierContourFeature : public MaterialFeature {
 public:
  static constexpr int kMostPoints = 64;

  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // in O, m; up to kMostPoints
    int harmonics = 3;                         // at least 1
    bool closed = true;
    std::vector<int> components{0, 1, 2};  // of 0 = x, 1 = y, 2 = z; those of the contour's plane
  };

  /// Throws std::invalid_argument where a point is not of the mesh, two are nearer than
  /// kNearestPair, components are not different axes, or the points are too few, or too unevenly
  /// spaced, to tell the coefficients apart.
  FourierContourFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "fourier_contour"; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;

 private:
  std::vector<int> components_;
  Eigen::MatrixXd fit_;  // coefficients of one component from that component of the points
};

}  // namespace palpate::shape
