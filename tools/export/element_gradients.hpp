#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/log/plant_truth.hpp"

namespace palpate::exporting {

/// Constitutive law: that of palpated's model, or that of the simulator's object.
enum class Law { kCorotational, kNeoHookean };

/// Stiffness of an object: from ESTIMATE, or given by the user.
struct Stiffness {
  double young_modulus = 0;  // Pa
  double poisson_ratio = 0;
};

/// Cauchy stress, Pa, at the deformation gradient F, with E = R^T F - 1 and J = det F:
///    co-rotational  R (2 mu E + lambda tr(E) 1) (1 + E) R^T / J
///    Neo-Hookean    (mu (F F^T - 1) + lambda log(J) 1) / J
/// J is limited from below to kSmallestVolumeShare.
inline constexpr double kSmallestVolumeShare = 0.01;
Eigen::Matrix3d cauchy_stress(Law law, const Eigen::Matrix3d& F, const Stiffness& stiffness);

/// Deformation of the elements of a mesh: tetrahedra by their corners, straight-sided ones of ten
/// nodes at four points, or 27-node hexahedra whose rest shape is a box, at 2 x 2 x 2 Gauss points.
class ElementGradients {
 public:
  /// Throws std::runtime_error if the mesh has other elements, or one without volume.
  explicit ElementGradients(const log::MeshMessage& mesh);

  int element_count() const { return static_cast<int>(elements_.cols()); }
  int points_per_element() const { return points_; }
  /// Rest volume associated with a point, m^3.
  double volume(int element, int point) const { return volumes_[index(element, point)]; }
  /// Deformation gradient at a point, for node positions x, 3 x n.
  Eigen::Matrix3d at(int element, int point, const Eigen::Matrix3Xd& x) const;
  /// Gradients of the shape functions in the rest shape, nodes per element x 3, 1/m.
  const Eigen::MatrixX3d& gradients(int element, int point) const {
    return gradients_[index(element, point)];
  }
  const Eigen::MatrixXi& elements() const { return elements_; }

 private:
  void add_tetrahedra(const Eigen::Matrix3Xd& nodes);
  void add_quadratic_tetrahedra(const Eigen::Matrix3Xd& nodes);
  void add_hexahedra(const Eigen::Matrix3Xd& nodes);
  std::size_t index(int element, int point) const {
    return static_cast<std::size_t>(element) * static_cast<std::size_t>(points_) +
           static_cast<std::size_t>(point);
  }

  Eigen::MatrixXi elements_;
  int points_ = 1;
  std::vector<double> volumes_;
  std::vector<Eigen::MatrixX3d> gradients_;
};

/// Position of each node of a box-shaped 27-node hexahedron on its grid: 0, 1 or 2 along each axis.
Eigen::Matrix3Xi grid_places(const Eigen::Matrix3Xd& nodes);

/// Edges of the elements on the surface of a mesh, as columns of two nodes; without the
/// lines through the faces of quadratic elements. kSharp: edges at which the rest surface turns by
/// more than 40 deg.
enum class Edges { kAll, kSharp };
Eigen::Matrix2Xi surface_edges(const log::MeshMessage& mesh, Edges which);

}  // namespace palpate::exporting
