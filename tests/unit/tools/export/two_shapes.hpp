#pragma once

#include <array>
#include <map>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::exporting {

/// A box [0, size] of tetrahedra, as palpated would publish it.
inline log::MeshMessage tetrahedral_box(const Eigen::Vector3d& size,
                                        const std::array<int, 3>& cells,
                                        mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  const mesh::ElementMesh box = mesh::make_element_mesh(mesh::make_box(size, cells), order);
  log::MeshMessage message;
  message.hash = 11;
  message.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  if (order == mesh::ElementOrder::kLinear) message.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
  message.nodes = box.nodes;
  message.elements = box.elements;
  message.triangles = mesh::extract_surface(box).triangles;
  for (Eigen::Index i = 0; i < box.nodes.cols(); ++i)
    if (box.nodes(0, i) == 0) message.constrained.push_back(static_cast<int>(i));
  return message;
}

/// The same box of 27-node hexahedra, as the simulator would: nodes with x running fastest.
inline log::MeshMessage hexahedral_box(const Eigen::Vector3d& size,
                                       const std::array<int, 3>& cells) {
  const int nx = 2 * cells[0] + 1, ny = 2 * cells[1] + 1, nz = 2 * cells[2] + 1;
  log::MeshMessage message;
  message.hash = 22;
  message.element_kind = shape_mesh_t::QUADRATIC_HEXAHEDRA;
  message.nodes.resize(3, nx * ny * nz);
  const auto node = [nx, ny](int i, int j, int k) { return i + nx * (j + ny * k); };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        message.nodes.col(node(i, j, k)) << size.x() * i / (nx - 1), size.y() * j / (ny - 1),
            size.z() * k / (nz - 1);
  message.elements.resize(27, cells[0] * cells[1] * cells[2]);
  int element = 0;
  for (int c = 0; c < cells[2]; ++c)
    for (int b = 0; b < cells[1]; ++b)
      for (int a = 0; a < cells[0]; ++a, ++element)
        for (int n = 0; n < 27; ++n)
          message.elements(n, element) = node(2 * a + n % 3, 2 * b + n / 3 % 3, 2 * c + n / 9);
  // Both triangles of each quarter of each outer face.
  std::vector<std::array<int, 3>> triangles;
  const std::array<int, 3> counts{nx, ny, nz};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool is_upper : {false, true})
      for (int p = 0; p + 1 < counts[u]; ++p)
        for (int q = 0; q + 1 < counts[v]; ++q) {
          const auto at = [&](int dp, int dq) {
            std::array<int, 3> place{};
            place[axis] = is_upper ? counts[axis] - 1 : 0;
            place[u] = p + dp;
            place[v] = q + dq;
            return node(place[0], place[1], place[2]);
          };
          const std::array<int, 4> quad{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (is_upper) {
            triangles.push_back({quad[0], quad[1], quad[2]});
            triangles.push_back({quad[0], quad[2], quad[3]});
          } else {
            triangles.push_back({quad[0], quad[2], quad[1]});
            triangles.push_back({quad[0], quad[3], quad[2]});
          }
        }
  }
  message.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    message.triangles.col(static_cast<Eigen::Index>(t)) =
        Eigen::Map<const Eigen::Vector3i>(triangles[t].data());
  return message;
}

/// Chunk 0 of 1.
inline shape_mesh_t mesh_message(const log::MeshMessage& mesh) {
  shape_mesh_t message{};
  message.mesh_hash = mesh.hash;
  message.element_kind = mesh.element_kind;
  message.chunks = 1;
  message.node_count = static_cast<std::int32_t>(mesh.nodes.cols());
  for (Eigen::Index i = 0; i < mesh.nodes.size(); ++i)
    message.rest_xyz.push_back(static_cast<float>(mesh.nodes.data()[i]));
  message.rest_xyz_count = static_cast<std::int32_t>(message.rest_xyz.size());
  message.element_size = static_cast<std::int32_t>(mesh.elements.rows());
  message.elements.assign(mesh.elements.data(), mesh.elements.data() + mesh.elements.size());
  message.element_index_count = static_cast<std::int32_t>(message.elements.size());
  message.triangles.assign(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
  message.triangle_index_count = static_cast<std::int32_t>(message.triangles.size());
  message.constrained.assign(mesh.constrained.begin(), mesh.constrained.end());
  message.constrained_count = static_cast<std::int32_t>(message.constrained.size());
  return message;
}

inline shape_t shape_message(const log::MeshMessage& mesh, const Eigen::Matrix3Xd& positions,
                             std::int64_t utime) {
  shape_t message{};
  message.utime = utime;
  message.session = 5;
  message.mesh_hash = mesh.hash;
  message.chunks = 1;
  message.node_count = static_cast<std::int32_t>(positions.cols());
  for (Eigen::Index i = 0; i < positions.size(); ++i)
    message.xyz.push_back(static_cast<float>(positions.data()[i]));
  message.xyz_count = static_cast<std::int32_t>(message.xyz.size());
  return message;
}

}  // namespace palpate::exporting
