#include "tools/bridge/drake/shape_view.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::drake_bridge {
namespace {

template <class Message>
bool show(ShapeView& view, const char* channel, const Message& message, std::int64_t utime = 0) {
  std::vector<std::uint8_t> data(message.getEncodedSize());
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return view.take(channel, data.data(), static_cast<int>(data.size()), utime);
}

/// A tetrahedron whose node 4 is inside: it is not drawn.
shape_mesh_t tetrahedron() {
  shape_mesh_t mesh{};
  mesh.mesh_hash = 5;
  mesh.chunks = 1;
  mesh.node_count = 5;
  mesh.rest_xyz = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.2F, 0.2F, 0.2F};
  mesh.element_size = 4;
  mesh.elements = {0, 1, 2, 3};
  mesh.triangles = {3, 1, 2, 0, 2, 1, 0, 1, 3, 0, 3, 2};
  mesh.rest_xyz_count = static_cast<int>(mesh.rest_xyz.size());
  mesh.element_index_count = static_cast<int>(mesh.elements.size());
  mesh.triangle_index_count = static_cast<int>(mesh.triangles.size());
  return mesh;
}

shape_t moved(float z) {
  shape_t shape{};
  shape.mesh_hash = 5;
  shape.chunks = 1;
  shape.node_count = 5;
  shape.xyz = tetrahedron().rest_xyz;
  for (std::size_t i = 2; i < shape.xyz.size(); i += 3) shape.xyz[i] += z;
  shape.xyz_count = static_cast<int>(shape.xyz.size());
  return shape;
}

TEST(ShapeView, DrawsTheSurfaceWhereTheObjectIs) {
  ShapeView::Options options;
  options.X_WO.translation() = Eigen::Vector3d(0.5, -0.25, 1);
  ShapeView view(options);
  EXPECT_FALSE(show(view, "SHAPE", moved(0))) << "the mesh is not known yet";
  EXPECT_FALSE(show(view, "SHAPE_MESH", tetrahedron()));
  ASSERT_TRUE(show(view, "SHAPE", moved(2)));
  const ::drake::lcmt_viewer_geometry_data& geometry = view.message().geom.at(0);
  EXPECT_EQ(geometry.type, 4);
  EXPECT_EQ(geometry.position[1], -0.25F);
  EXPECT_EQ(geometry.quaternion[0], 1);
  ASSERT_EQ(geometry.float_data.size(), 2u + 3 * 4 + 3 * 4);
  EXPECT_EQ(geometry.num_float_data, static_cast<int>(geometry.float_data.size()));
  EXPECT_EQ(geometry.float_data[0], 4);
  EXPECT_EQ(geometry.float_data[1], 4);
  const std::vector<std::int32_t> triangles = tetrahedron().triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(geometry.float_data[14 + i]);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(geometry.float_data[2 + 3 * vertex + k],
                moved(2).xyz[3 * static_cast<std::size_t>(triangles[i]) + k]);
  }
}

TEST(ShapeView, KeepsItsRate) {
  ShapeView view({});
  show(view, "SHAPE_MESH", tetrahedron());
  int drawn = 0;
  for (std::int64_t us = 0; us < 1'000'000; us += 10'000)
    drawn += show(view, "SHAPE", moved(0), us) ? 1 : 0;
  EXPECT_EQ(drawn, 20);
}

TEST(ShapeView, LeavesOutWhatCannotBeDrawn) {
  ShapeView view({});
  show(view, "SHAPE_MESH", tetrahedron());
  shape_t shape = moved(0);
  shape.xyz[4] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(show(view, "SHAPE", shape));
  shape = moved(0);
  shape.mesh_hash = 6;
  EXPECT_FALSE(show(view, "SHAPE", shape));
  EXPECT_FALSE(view.take("SHAPE", "short", 5, 0));
  EXPECT_FALSE(show(view, "SHAPE_MESH", moved(0)));
  EXPECT_TRUE(show(view, "SHAPE", moved(0)));
}

}  // namespace
}  // namespace palpate::drake_bridge
