#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Numbers of elements in a non-physical state.
struct ElementDoubts {
  int inverted = 0;  // inverted somewhere: det F <= 0
  int strained = 0;  // strained above a limit somewhere
};

/// Lame parameters, Pa.
struct Lame {
  double mu = 0;
  double lambda = 0;
};
Lame lame(const Material& material);

/// Materials of a body's elements.
struct ElementMaterials {
  /// `law`: as Body::law.
  ElementMaterials(std::vector<Lame> lame_by_element, std::optional<StretchLaw> law_of_all = {})
      : lame(std::move(lame_by_element)), law(law_of_all) {}

  std::vector<Lame> lame;  // by element
  std::optional<StretchLaw> law;
};
/// Those of a body.
ElementMaterials element_materials(const Body& body);

/// Straight-sided tetrahedra: 4 nodes and one quadrature point, or 10 nodes and four points, which
/// integrate the energy exactly if the rotation is constant.
template <int kNodes>
struct Tetrahedron {
  static constexpr int kPoints = kNodes == 4 ? 1 : 4;
  using Gradients = Eigen::Matrix<double, 3, kNodes>;

  /// d N_a / d X at each quadrature point (column a, 1/m), from the rest corners.
  static std::array<Gradients, kPoints> gradients(const Eigen::Matrix<double, 3, 4>& corners);

  /// Integral of N_a N_b over the element, divided by its volume.
  static Eigen::Matrix<double, kNodes, kNodes> mass_shares();

  /// Integral of N_a over the element, divided by its volume.
  static Eigen::Matrix<double, kNodes, 1> volume_shares();
};

/// Barycentric coordinates of the four quadrature points of a quadratic element (degree 2): kNear
/// for one corner, kFar for the others.
inline constexpr double kNear = 0.58541019662496845446, kFar = 0.13819660112501051518;

/// Gradients of the four barycentric coordinates, columns, 1/m.
Eigen::Matrix<double, 3, 4> barycentric_gradients(const Eigen::Matrix<double, 3, 4>& corners);

/// Signed volume of a tetrahedron, m^3.
double tetrahedron_volume(const Eigen::Matrix<double, 3, 4>& corners);

enum class Tangent {
  kExact,         // second derivative of the energy
  kSemidefinite,  // the same with its negative eigenvalues at each point set to zero
  kWarped,        // R K0 R^T: constant rotations, Mueller and Gross 2004
};

/// Tangent of a quadrature point with deformation gradient F:
///   K_ab = w [ (h_a . h_b) s I + l h_a h_b^T + [h_a]x twist [h_b]x ],  h_a = R grad N_a,
/// which is the co-rotated tangent with the derivative of R written explicitly.
struct PointTangent {
  Eigen::Matrix3d rotation;
  Eigen::Matrix3d twist;  // Pa, in the rotated axes
  double s = 0;           // 2 mu, Pa
  double l = 0;           // lambda, Pa
};

/// Twist term of a point with symmetric stretch S = R^T F, in its own axes. Where the rotation is
/// not stable, i.e. H = tr(S) I - S is not positive definite with a determinant above
/// kSmallestTurnStiffness, H is bounded away from zero.
Eigen::Matrix3d point_twist(const Eigen::Matrix3d& S, const Lame& lame, Tangent kind);
inline constexpr double kSmallestTurnStiffness = 1e-3;

/// `viscous`: adds this multiple of the warped stiffness (Rayleigh damping over one implicit step).
PointTangent point_tangent(const Eigen::Matrix3d& F, const Lame& lame, Tangent kind,
                           double viscous = 0);

}  // namespace palpate::elasticity
