#pragma once

#include <memory>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/elasticity/element.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

/// Nodal vectors as the solvers keep them, 3 x n with a row of padding.
using NodalField = Eigen::Matrix4Xd;

/// Of the arithmetic inside elements. Positions and sums over elements are in double always.
enum class Precision {
  kSingle,  // eight points at once; strains are exact to some 1e-7
  kDouble,  // four points at once
};

/// Forces of all elements of a body. Remembers rotations and strains from one evaluation to the
/// next, so one thread, with its team, uses it at a time. Nodes are numbered as the solver that
/// owns it likes.
class ElementForces {
 public:
  virtual ~ElementForces() = default;

  /// Adds dEnergy/dx (N: the force that the nodes must be given from outside) at positions `x` (m)
  /// to `forces` and returns the energy in J. `viscosity` > 0 adds the potential of Rayleigh
  /// damping since begin_step: stiffness factor over time step. Inverted elements are allowed.
  virtual double add(const NodalField& x, double viscosity, NodalField& forces) noexcept = 0;

  /// The strains of the last evaluation become those at the beginning of a step.
  virtual void begin_step() noexcept = 0;

  /// Undeformed and unturned.
  virtual void reset() noexcept = 0;

  /// Mean rotation of the elements round each node at the last evaluation, as unit quaternions
  /// w x y z; `rotations` holds a recent answer (4 x n) that fixes their signs. Midside nodes take
  /// the mean of their corners. Nodes without elements keep what they had.
  virtual void node_rotations(Eigen::Matrix4Xf& rotations) noexcept = 0;

  /// Elements that are inside out (at a quadrature point, or at a corner of a quadratic element) or
  /// strained by more than `limit` (Frobenius norm at a quadrature point) at `x`, the positions of
  /// the last evaluation.
  virtual ElementDoubts doubts(const NodalField& x, double limit) const noexcept = 0;
};

/// `numbering[node]` is the column of a mesh node in nodal fields. `materials`: Lame's constants of
/// each element. `team` outlives the result; its size, but nothing else of it, decides the order
/// in which elements' forces are added up. Throws std::invalid_argument where an element has no
/// positive volume.
std::unique_ptr<ElementForces> make_element_forces(const mesh::ElementMesh& mesh,
                                                   const std::vector<Lame>& materials,
                                                   const std::vector<int>& numbering,
                                                   Precision precision,
                                                   math::Team& team = math::solo_team);

/// Nodes in the order of the mesh.
std::vector<int> mesh_numbering(const mesh::ElementMesh& mesh);

}  // namespace palpate::elasticity
