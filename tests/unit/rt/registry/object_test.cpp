// What is remarked on boxes that do not meet the mesh.

#include "rt/registry/object.hpp"

#include <gtest/gtest.h>

namespace palpate::registry {
namespace {

Object object_of(const std::string& cells, const std::string& boxes,
                 std::vector<std::string>* remarks) {
  const config::Node root = config::Node::from_text(
      "object:\n  mesh: {box: {size: [0.2, 0.2, 0.2], cells: " + cells + R"(}}
  material: {young_modulus: 30e3, poisson_ratio: 0.3, density: 26}
)" + boxes,
      "block.yaml");
  return read_object(root, Frames(), remarks);
}

/// Remarks on a block of 0.2 m in two cells along each edge, with nodes every 50 mm. One row of
/// corners is free to move to a bound.
std::vector<std::string> remarks_on(const std::string& boxes) {
  std::vector<std::string> remarks;
  object_of("[2, 2, 2]", boxes, &remarks);
  return remarks;
}

TEST(Object, RowsOfNodesMoveToTheBoundsOfClampAndGrasps) {
  std::vector<std::string> remarks;
  const Object object =
      object_of("[5, 5, 5]",
                "  fixed_box: {lower: [0, 0, 0], upper: [0.001, 0.2, 0.2]}\n"
                "  grasp_box: {lower: [0.1667, 0, 0.03], upper: [0.2, 0.2, 0.15]}\n",
                &remarks);
  EXPECT_TRUE(remarks.empty());
  const Eigen::Matrix3Xd& nodes = object.corners.nodes;
  const auto has_row = [&](int axis, double at) {
    return (nodes.row(axis).array() - at).abs().minCoeff() < 1e-12;
  };
  for (const double x : {0.0, 0.1667 / 4, 0.1667, 0.2}) EXPECT_TRUE(has_row(0, x)) << x;
  for (const double y : {0.0, 0.04, 0.16}) EXPECT_TRUE(has_row(1, y)) << y;
  for (const double z : {0.03, 0.15}) EXPECT_TRUE(has_row(2, z)) << z;
  EXPECT_EQ(object.corners.node_count(), 6 * 6 * 6);
}

TEST(Object, ABoundBetweenRowsOfNodesIsRemarkedWithBothPlaces) {
  const std::vector<std::string> remarks = remarks_on(
      "  fixed_box: {lower: [0, 0, 0], upper: [0.03, 0.2, 0.2]}\n"
      "  grasp_box: {lower: [0.1667, 0, 0], upper: [0.2, 0.2, 0.2]}\n");
  ASSERT_EQ(remarks.size(), 1u);
  for (const char* part : {"object.grasp_box.lower", "x = 0.1667 m", "x = 0.2 m", "x = 0.115 m"})
    EXPECT_NE(remarks[0].find(part), std::string::npos) << part << " in " << remarks[0];
}

TEST(Object, EveryBoundOfEveryBoxIsLookedAt) {
  const std::vector<std::string> remarks = remarks_on(
      "  fixed_box: {lower: [0, 0.03, 0], upper: [0.01, 0.18, 0.2]}\n"
      "  grasp_box: {lower: [0.17, 0, 0.03], upper: [0.3, 0.3, 0.18]}\n");
  ASSERT_EQ(remarks.size(), 3u);
  EXPECT_EQ(remarks[0].find("object.fixed_box.upper: y = 0.18 m"), 0u) << remarks[0];
  EXPECT_NE(remarks[0].find("fixed nodes end at y = 0.115 m"), std::string::npos) << remarks[0];
  EXPECT_EQ(remarks[1].find("object.grasp_box.lower: x = 0.17 m"), 0u) << remarks[1];
  EXPECT_EQ(remarks[2].find("object.grasp_box.upper: z = 0.18 m"), 0u) << remarks[2];
}

TEST(Object, ABoundAtARowOfNodesOrBeyondTheBodyIsNotRemarked) {
  EXPECT_TRUE(remarks_on("  fixed_box: {lower: [-1, -1, -1], upper: [0.001, 1, 1]}\n"
                         "  grasp_box: {lower: [0.149, 0.05, 0], upper: [0.25, 0.1504, 0.2]}\n")
                  .empty());
}

}  // namespace
}  // namespace palpate::registry
