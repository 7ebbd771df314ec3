#pragma once

#include <vector>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/node_transfer.hpp"

namespace palpate::bench {

/// Energy and forces of isoparametric quadratic tetrahedra, four elements at a time in double, in
/// the layout of the loop's straight ones: to determine the cost of curved elements. In addition to
/// the straight element's data, each point has separate gradients and a weight, 40 numbers instead
/// of 11.
class CurvedPass {
 public:
  explicit CurvedPass(const elasticity::Body& body);

  /// Adds dEnergy/dx (N) at x (m) to `forces`, in the numbering of the mesh; returns J.
  double add(const elasticity::NodalField& x, elasticity::NodalField& forces) noexcept;

 private:
  using Pack = math::Pack4d;
  using Vector = elasticity::PackVector<Pack>;
  struct alignas(64) Block {
    std::array<std::array<int, 4>, 10> offsets;      // in nodal fields
    std::array<std::array<Vector, 3>, 4> gradients;  // of barycentric coordinates 1, 2, 3; by point
    std::array<Pack, 4> mu, lambda;                  // times the volume of the point, J
  };
  Pack add_block(const double* x, std::size_t block, double* forces) noexcept;

  std::vector<Block> blocks_;
  std::vector<std::array<elasticity::PointState<Pack>, 4>> state_;
};

}  // namespace palpate::bench
