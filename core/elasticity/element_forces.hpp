#pragma once

#include <memory>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/elasticity/element.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

/// Nodal vectors as stored by the solvers, 3 x n with a row of padding.
using NodalField = Eigen::Matrix4Xd;

/// Precision of the arithmetic inside elements. Positions and sums over elements are always in
/// double.
enum class Precision {
  kSingle,  // eight points at once; strains are accurate to about 1e-7
  kDouble,  // four points at once
};

/// Forces of all elements of a body. Keeps rotations and strains between evaluations; not
/// thread-safe, except for its own team. Nodes are numbered by the owning solver.
class ElementForces {
 public:
  virtual ~ElementForces() = default;

  /// Adds dEnergy/dx (N: the external force required at the nodes) at positions `x` (m) to `forces`
  /// and returns the energy, J. `viscosity` > 0 adds the potential of Rayleigh damping since
  /// begin_step(): stiffness factor divided by time step. Inverted elements are permitted.
  virtual double add(const NodalField& x, double viscosity, NodalField& forces) noexcept = 0;

  /// Stores the strains of the last evaluation as those at the beginning of a step.
  virtual void begin_step() noexcept = 0;

  /// Resets to zero strain and identity rotations.
  virtual void reset() noexcept = 0;

  /// Mean rotation of the elements around each node at the last evaluation, as unit quaternions w x
  /// y z; `rotations` (4 x n) contains an earlier result, which determines their signs. Midside
  /// nodes get the mean of their corners. Nodes without elements are unchanged.
  virtual void node_rotations(Eigen::Matrix4Xf& rotations) noexcept = 0;

  /// Elements that are inverted (at a quadrature point, or at a corner of a quadratic element) or
  /// strained above `limit` (Frobenius norm at a quadrature point) at `x`, the positions of the
  /// last evaluation.
  virtual ElementDoubts doubts(const NodalField& x, double limit) const noexcept = 0;
};

/// `numbering[node]`: column of a mesh node in nodal fields. `team` must outlive the result; its
/// size determines the summation order of the elements' forces. Throws std::invalid_argument if an
/// element has no positive volume.
std::unique_ptr<ElementForces> make_element_forces(const mesh::ElementMesh& mesh,
                                                   const ElementMaterials& materials,
                                                   const std::vector<int>& numbering,
                                                   Precision precision,
                                                   math::Team& team = math::solo_team);

/// Identity numbering: nodes in mesh order.
std::vector<int> mesh_numbering(const mesh::ElementMesh& mesh);

}  // namespace palpate::elasticity
