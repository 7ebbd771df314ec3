#include "tools/log/plant_truth.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::log {
namespace {

/// Quadratic in every coordinate: 27-node hexahedra represent it exactly.
Eigen::Vector3d bend(const Eigen::Vector3d& p, double) {
  return {p.x() * (1 - 2 * p.z()), p.y() + p.x() * p.x() * p.z() * p.z(),
          p.z() + 0.5 * p.x() * p.x() - p.y() * p.y() * p.x()};
}

TEST(PlantTruth, ChunksBecomeOneMesh) {
  const auto chunks =
      scores::mesh_chunks(scores::plant_rest(), shape_mesh_t::QUADRATIC_HEXAHEDRA, 5);
  const MeshMessage mesh = assemble({chunks[1], chunks[1], chunks[0]});
  EXPECT_EQ(mesh.hash, 5);
  EXPECT_LT((mesh.nodes - scores::plant_rest()).norm(), 1e-6);
  EXPECT_EQ(mesh.elements.rows(), 27);
  EXPECT_NEAR(mesh.longest_side(), 0.4, 1e-6);
  EXPECT_THROW(assemble({chunks[1]}), std::runtime_error);
}

TEST(PlantTruth, InterpolatesQuadraticFieldsExactlyInAnyNodeOrder) {
  const MeshMessage mesh =
      assemble(scores::mesh_chunks(scores::plant_rest(), shape_mesh_t::QUADRATIC_HEXAHEDRA, 5));
  Eigen::Matrix3Xd points(3, 3);
  points << 0.07, 0.4, 0.33, 0.02, 0.1, 0.09, 0.19, 0, 0.111;
  const Eigen::Matrix3Xd found =
      PlantPoints(mesh, points).at(scores::moved(scores::plant_rest(), bend, 0));
  EXPECT_LT((found - scores::moved(points, bend, 0)).norm(), 1e-6);
}

TEST(PlantTruth, InterpolatesLinearFieldsExactlyInTetrahedra) {
  const auto shear = [](const Eigen::Vector3d& p, double) {
    return Eigen::Vector3d(p.x() + 0.5 * p.z(), 1.2 * p.y() - p.x(), p.z() + 0.1);
  };
  const MeshMessage mesh =
      assemble(scores::mesh_chunks(scores::estimate_rest(), shape_mesh_t::LINEAR_TETRAHEDRA, 5));
  Eigen::Matrix3Xd points(3, 2);  // the second lies outside
  points << 0.2, 0.3, 0.04, 0.08, 0.11, 0.15;
  const Eigen::Matrix3Xd found =
      PlantPoints(mesh, points).at(scores::moved(scores::estimate_rest(), shear, 0));
  EXPECT_LT((found - scores::moved(points, shear, 0)).norm(), 1e-6);
}

TEST(PlantTruth, ElementsOfTheWrongKindAreRefused) {
  const MeshMessage mesh =
      assemble(scores::mesh_chunks(scores::plant_rest(), shape_mesh_t::QUADRATIC_TETRAHEDRA, 5));
  EXPECT_THROW(PlantPoints(mesh, scores::estimate_rest()), std::runtime_error);
}

TEST(PlantTruth, MotionIsLinearBetweenMessagesAndEndsWithThem) {
  std::vector<shape_t> truths{scores::shape_at(1, Eigen::Matrix3Xd::Zero(3, 2), 1),
                              scores::shape_at(2, Eigen::Matrix3Xd::Constant(3, 2, 4), 1)};
  const PlantMotion motion(truths);
  Eigen::Matrix3Xd positions;
  ASSERT_TRUE(motion.at(1250000, positions));
  EXPECT_NEAR(positions(1, 1), 1.0, 1e-12);
  EXPECT_TRUE(motion.at(2000000, positions));
  EXPECT_FALSE(motion.at(999999, positions));
  EXPECT_FALSE(motion.at(2000001, positions));
}

}  // namespace
}  // namespace palpate::log
