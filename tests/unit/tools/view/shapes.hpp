#pragma once

#include <memory>
#include <palpate/shape_t.hpp>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"
#include "tools/view/mesh_book.hpp"

namespace palpate::view {

/// SHAPE_MESH of a box of tetrahedra, in `count` chunks.
inline std::vector<shape_mesh_t> box_chunks(const std::array<int, 3>& cells, int count = 1,
                                            const Eigen::Vector3d& size = {0.4, 0.2, 0.1}) {
  const mesh::TetrahedralMesh box = mesh::make_box(size, cells);
  const mesh::Surface surface =
      mesh::extract_surface(mesh::make_element_mesh(box, mesh::ElementOrder::kLinear));
  std::vector<shape_mesh_t> chunks(static_cast<std::size_t>(count));
  const auto deal = [&](const auto& matrix, auto member) {
    for (int c = 0; c < matrix.cols(); ++c)
      for (int r = 0; r < matrix.rows(); ++r) {
        auto& list = chunks[static_cast<std::size_t>(c * count / matrix.cols())].*member;
        list.push_back(
            static_cast<typename std::decay_t<decltype(list)>::value_type>(matrix(r, c)));
      }
  };
  deal(box.nodes, &shape_mesh_t::rest_xyz);
  deal(box.tetrahedra, &shape_mesh_t::elements);
  deal(surface.triangles, &shape_mesh_t::triangles);
  int first = 0;
  for (int i = 0; i < count; ++i) {
    shape_mesh_t& c = chunks[static_cast<std::size_t>(i)];
    c.mesh_hash = 77;
    c.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
    c.element_size = 4;
    c.chunk = static_cast<std::int16_t>(i);
    c.chunks = static_cast<std::int16_t>(count);
    c.corner_count = box.node_count();
    c.first_node = first;
    first += static_cast<int>(c.rest_xyz.size()) / 3;
    if (i == 0) c.constrained = {0, 1};
    c.rest_xyz_count = static_cast<int>(c.rest_xyz.size());
    c.element_index_count = static_cast<int>(c.elements.size());
    c.triangle_index_count = static_cast<int>(c.triangles.size());
    c.constrained_count = static_cast<int>(c.constrained.size());
  }
  return chunks;
}

inline std::shared_ptr<const ViewMesh> box_mesh(const std::array<int, 3>& cells) {
  MeshBook book;
  for (const shape_mesh_t& chunk : box_chunks(cells)) book.add(chunk);
  return book.find(77);
}

/// A message as encoded on the bus.
template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

/// SHAPE of that box, each node at `place` of its rest position.
template <class Place>
shape_t shape_of(const ViewMesh& mesh, Place place) {
  shape_t shape{};
  shape.mesh_hash = mesh.hash;
  shape.node_count = mesh.node_count;
  for (int n = 0; n < mesh.node_count; ++n) {
    const Eigen::Vector3f x = place(Eigen::Vector3f(Eigen::Vector3f::Map(&mesh.rest_xyz[3 * n])));
    shape.xyz.insert(shape.xyz.end(), x.data(), x.data() + 3);
  }
  shape.xyz_count = 3 * shape.node_count;
  return shape;
}

}  // namespace palpate::view
