#include "core/mesh/mesh_formats.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::mesh {
namespace {

/// A header may announce more than the file contains, so memory is allocated as lines are read.
template <typename Matrix>
void make_room(Matrix& matrix, int column, int count) {
  if (column < matrix.cols()) return;
  const Eigen::Index wanted = std::max<Eigen::Index>(1024, 2 * matrix.cols());
  matrix.conservativeResize(Eigen::NoChange, std::min<Eigen::Index>(count, wanted));
}

}  // namespace

Eigen::Matrix3Xd read_tetgen_nodes(LineReader& reader, long& first, OnFault on_fault) {
  const int count = reader.count(0);
  if (reader.size() > 1 && reader.integer(1) != 3) reader.fail("nodes must have 3 dimensions");
  Eigen::Matrix3Xd nodes;
  for (int n = 0; n < count; ++n) {
    reader.require("node " + std::to_string(n + 1) + " of " + std::to_string(count));
    const long index = reader.integer(0);
    if (n == 0) {
      if (index != 0 && index != 1) reader.fail("the first node must be numbered 0 or 1");
      first = index;
    }
    if (index != first + n) {
      reader.fail("node " + std::to_string(index) + " where " + std::to_string(first + n) +
                  " should come");
    }
    make_room(nodes, n, count);
    for (int i = 0; i < 3; ++i) {
      nodes(i, n) = reader.number(1 + i);
      if (!std::isfinite(nodes(i, n)) && on_fault == OnFault::kThrow) {
        reader.fail("a coordinate is not finite");
      }
    }
  }
  return nodes;
}

Eigen::Matrix4Xi read_tetgen_elements(LineReader& reader, long first, int node_count,
                                      OnFault on_fault) {
  const int count = reader.count(0);
  const long corners = reader.size() > 1 ? reader.integer(1) : 4;
  if (corners != 4 && corners != 10) reader.fail("tetrahedra must have 4 or 10 nodes");
  Eigen::Matrix4Xi tetrahedra;
  for (int t = 0; t < count; ++t) {
    reader.require("tetrahedron " + std::to_string(t + 1) + " of " + std::to_string(count));
    reader.integer(0);
    make_room(tetrahedra, t, count);
    for (int i = 0; i < 4; ++i) {
      const long node = reader.integer(1 + i) - first;
      const bool exists = node >= 0 && node < node_count;
      if (!exists && on_fault == OnFault::kThrow) {
        reader.fail("there is no node " + std::to_string(node + first));
      }
      tetrahedra(i, t) = exists ? static_cast<int>(node) : -1;
    }
  }
  return tetrahedra;
}

MeshWithGroups read_tetgen(std::istream& node, const std::string& node_name, std::istream& ele,
                           const std::string& ele_name, OnFault on_fault) {
  MeshWithGroups result;
  long first = 0;
  LineReader nodes(node, node_name, '#');
  nodes.require("the number of nodes");
  result.mesh.nodes = read_tetgen_nodes(nodes, first, on_fault);
  LineReader elements(ele, ele_name, '#');
  elements.require("the number of tetrahedra");
  result.mesh.tetrahedra =
      read_tetgen_elements(elements, first, result.mesh.node_count(), on_fault);
  result.number_from(first);
  return result;
}

}  // namespace palpate::mesh
