#include "sim/scenes/truth_publisher.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

TEST(TruthPublisher, ChunksOfAFineMeshFitDatagramsAndMakeItWhole) {
  object::PlantOptions options;
  options.elements = {30, 4, 4};
  const object::HyperelasticPlant plant(options);
  const std::vector<shape_mesh_t> chunks = mesh_chunks(plant);
  ASSERT_GT(chunks.size(), 1u);
  std::vector<float> nodes;
  std::vector<int> elements, triangles, constrained;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const shape_mesh_t& c = chunks[i];
    EXPECT_LT(c.getEncodedSize(), 60000);
    EXPECT_EQ(c.chunk, static_cast<int>(i));
    EXPECT_EQ(c.chunks, static_cast<int>(chunks.size()));
    EXPECT_EQ(c.element_size, 27);
    EXPECT_EQ(c.mesh_hash, chunks[0].mesh_hash);
    if (c.rest_xyz_count > 0) {
      EXPECT_EQ(3 * c.first_node, static_cast<int>(nodes.size()));
    }
    EXPECT_EQ(c.element_index_count % 27, 0);
    nodes.insert(nodes.end(), c.rest_xyz.begin(), c.rest_xyz.end());
    elements.insert(elements.end(), c.elements.begin(), c.elements.end());
    triangles.insert(triangles.end(), c.triangles.begin(), c.triangles.end());
    constrained.insert(constrained.end(), c.constrained.begin(), c.constrained.end());
  }
  ASSERT_EQ(nodes.size(), static_cast<std::size_t>(plant.rest_positions().size()));
  EXPECT_TRUE(Eigen::Map<const Eigen::Matrix3Xf>(nodes.data(), 3, nodes.size() / 3)
                  .isApprox(plant.rest_positions().cast<float>()));
  ASSERT_EQ(elements.size(), static_cast<std::size_t>(plant.elements().size()));
  EXPECT_TRUE(std::equal(elements.begin(), elements.end(), plant.elements().data()));
  ASSERT_EQ(triangles.size(), static_cast<std::size_t>(plant.surface_triangles().size()));
  EXPECT_TRUE(std::equal(triangles.begin(), triangles.end(), plant.surface_triangles().data()));
  EXPECT_EQ(constrained, plant.clamped_nodes());
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
