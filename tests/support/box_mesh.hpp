#pragma once

#include <array>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::support {

/// SHAPE_MESH of a box of tetrahedra as one whole message, with hash 77 and two constrained nodes.
inline shape_mesh_t box_mesh(const std::array<int, 3>& cells,
                             const Eigen::Vector3d& size = {0.4, 0.2, 0.1},
                             mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  const mesh::ElementMesh box = mesh::make_element_mesh(mesh::make_box(size, cells), order);
  const mesh::Surface surface = mesh::extract_surface(box);
  shape_mesh_t message{};
  message.mesh_hash = 77;
  message.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  if (order == mesh::ElementOrder::kLinear) message.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
  message.chunks = 1;
  message.node_count = box.node_count();
  message.element_size = box.nodes_per_element();
  message.rest_xyz.assign(box.nodes.data(), box.nodes.data() + box.nodes.size());
  message.elements.assign(box.elements.data(), box.elements.data() + box.elements.size());
  message.triangles.assign(surface.triangles.data(),
                           surface.triangles.data() + surface.triangles.size());
  message.constrained = {0, 1};
  message.rest_xyz_count = static_cast<int>(message.rest_xyz.size());
  message.element_index_count = static_cast<int>(message.elements.size());
  message.triangle_index_count = static_cast<int>(message.triangles.size());
  message.constrained_count = static_cast<int>(message.constrained.size());
  return message;
}

/// SHAPE of a mesh, each node at `place` of its rest position.
template <class Place>
shape_t shape_of(const shape_mesh_t& mesh, Place place) {
  shape_t shape{};
  shape.mesh_hash = mesh.mesh_hash;
  shape.chunks = 1;
  shape.node_count = mesh.node_count;
  for (int n = 0; n < mesh.node_count; ++n) {
    const Eigen::Vector3f x = place(Eigen::Vector3f(Eigen::Vector3f::Map(&mesh.rest_xyz[3 * n])));
    shape.xyz.insert(shape.xyz.end(), x.data(), x.data() + 3);
  }
  shape.xyz_count = 3 * shape.node_count;
  return shape;
}

}  // namespace palpate::support
