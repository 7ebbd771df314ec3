#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh {

/// Material point as a weighted sum of node positions: the shape functions of its element.
struct PointWeights {
  int count = 0;  // 4 or 10
  std::array<int, 10> nodes{};
  std::array<double, 10> weights{};
  double outside = 0;  // m, distance of the point from the mesh; 0 inside

  Eigen::Vector3d interpolate(const Eigen::Matrix3Xd& positions) const {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int i = 0; i < count; ++i) p += weights[i] * positions.col(nodes[i]);
    return p;
  }
};

/// Finds the element that contains a rest point. A point outside is extrapolated from the nearest
/// element, and `outside` is its distance. The mesh must outlive the locator and have at least one
/// element; elements without volume are ignored.
class PointLocator {
 public:
  explicit PointLocator(const ElementMesh& mesh);
  explicit PointLocator(ElementMesh&&) = delete;

  PointWeights locate(const Eigen::Vector3d& p_O) const;

 private:
  const ElementMesh& mesh_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // one per element
};

}  // namespace palpate::mesh
