#pragma once

#include <Eigen/Core>
#include <optional>

#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {

using Tensors = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // xx yy zz xy xz yz

/// Law of a material: that of palpated's model, and that of the simulator's object.
enum class Law { kCorotational, kNeoHookean };

/// Stiffness of an object: of ESTIMATE, or told by the user.
struct Stiffness {
  double young_modulus = 0;  // Pa
  double poisson_ratio = 0;
};

/// What a shape says beyond its positions. By node, 3 x n, and by element.
struct ShapeFields {
  Eigen::Matrix3Xd displacement;      // m, from rest
  Tensors strain;                     // Green-Lagrange, mean of the element, in the axes at rest
  Eigen::VectorXd equivalent_strain;  // sqrt(2/3 |dev E|^2)
  // Where the stiffness is known, otherwise empty:
  Tensors stress;             // Cauchy, Pa, mean of the element
  Eigen::VectorXd von_mises;  // Pa
  Eigen::Matrix3Xd force;     // N, what acts on each node from outside while it is in equilibrium
};

/// Evaluates the fields of one mesh. Of a mesh of quadratic tetrahedra only the corners are
/// published; its elements count as linear ones here, which are a little stiffer in bending.
class ShapeEvaluator {
 public:
  /// Throws as ElementGradients.
  ShapeEvaluator(const evaluate::MeshMessage& mesh, Law law);

  ShapeFields at(const Eigen::Matrix3Xd& positions,
                 const std::optional<Stiffness>& stiffness) const;

  /// A field of the elements at the nodes: the mean over the elements that meet there, weighted by
  /// their volume.
  Eigen::VectorXd at_nodes(const Eigen::VectorXd& by_element) const;

  const evaluate::MeshMessage& mesh() const { return mesh_; }

 private:
  void add_strain(const Eigen::Matrix3Xd& x, ShapeFields& fields) const;
  void add_stress(const Eigen::Matrix3Xd& x, const Stiffness& stiffness, ShapeFields& fields) const;

  Law law_;
  evaluate::MeshMessage mesh_;
  ElementGradients gradients_;
  Eigen::VectorXd element_volume_;
  Eigen::VectorXd node_volume_;  // of the elements around each
};

/// Cauchy stress, Pa, at the deformation gradient F, with E = R^T F - 1 and J = det F:
///   co-rotational  R (2 mu E + lambda tr(E) 1) (1 + E) R^T / J
///   Neo-Hookean    (mu (F F^T - 1) + lambda log(J) 1) / J
/// Where J is below a hundredth, it counts as that hundredth.
Eigen::Matrix3d cauchy_stress(Law law, const Eigen::Matrix3d& F, const Stiffness& stiffness);

}  // namespace palpate::exporting
