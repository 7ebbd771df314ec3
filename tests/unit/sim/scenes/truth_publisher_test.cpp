#include "sim/scenes/truth_publisher.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rt/bus/checked_decode.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

TEST(TruthPublisher, ChunksOfAFineMeshFitDatagramsAndMakeItWhole) {
  object::PlantOptions options;
  options.elements = {30, 4, 4};
  const object::HyperelasticPlant plant(options);
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub);
  std::vector<bus::Published> published;
  bus::record(*hub, &published);
  TruthPublisher publisher(*bus, plant, 1);
  publisher.publish_mesh(0);
  ASSERT_GT(published.size(), 1u);
  bus::MeshAssembler assembler;
  for (std::size_t i = 0; i < published.size(); ++i) {
    EXPECT_EQ(published[i].channel, "TRUTH_MESH");
    EXPECT_LT(published[i].data.size(), 60000u);
    shape_mesh_t chunk;
    ASSERT_TRUE(bus::checked_decode(chunk, published[i].data.data(),
                                    static_cast<int>(published[i].data.size())));
    EXPECT_EQ(chunk.element_size, 27);
    EXPECT_EQ(assembler.add(chunk), i + 1 == published.size());
  }
  const auto mesh = assembler.find(publisher.mesh_hash());
  ASSERT_NE(mesh, nullptr);
  EXPECT_EQ(mesh->element_kind, shape_mesh_t::QUADRATIC_HEXAHEDRA);
  ASSERT_EQ(mesh->node_count, plant.rest_positions().cols());
  EXPECT_TRUE(Eigen::Matrix3Xf::Map(mesh->rest_xyz.data(), 3, mesh->node_count)
                  .isApprox(plant.rest_positions().cast<float>()));
  ASSERT_EQ(mesh->elements.size(), static_cast<std::size_t>(plant.elements().size()));
  EXPECT_TRUE(std::equal(mesh->elements.begin(), mesh->elements.end(), plant.elements().data()));
  ASSERT_EQ(mesh->triangles.size(), static_cast<std::size_t>(plant.surface_triangles().size()));
  EXPECT_TRUE(
      std::equal(mesh->triangles.begin(), mesh->triangles.end(), plant.surface_triangles().data()));
  EXPECT_EQ(mesh->constrained, plant.clamped_nodes());
}

TEST(TruthPublisher, PublishesThePlantsShapeAndTheHandsWrench) {
  Stage stage(kSixPoses);
  stage.run(2.5);
  const Simulation& s = stage.simulation;
  const shape_t shape = stage.sent<shape_t>("TRUTH_SHAPE").back();
  EXPECT_EQ(shape.utime, s.utime());
  EXPECT_EQ(shape.mesh_hash, stage.sent<shape_mesh_t>("TRUTH_MESH").back().mesh_hash);
  EXPECT_EQ(shape.mesh_hash, s.mesh_hash());
  ASSERT_EQ(shape.node_count, s.plant().positions().cols());
  EXPECT_TRUE(Eigen::Map<const Eigen::Matrix3Xf>(shape.xyz.data(), 3, shape.node_count)
                  .isApprox(s.plant().positions().cast<float>()));
  const truth_contact_t contact = stage.sent<truth_contact_t>("TRUTH_CONTACT").back();
  EXPECT_EQ(contact.grasp_count, 1);
  EXPECT_EQ(Eigen::Vector3d(contact.grasp_position[0]), s.grasp_in_object().translation());
  EXPECT_EQ(math::Vector6d(contact.grasp_wrench[0]), s.plant().hand_wrench().vector());
}

}  // namespace
}  // namespace palpate::scenes
