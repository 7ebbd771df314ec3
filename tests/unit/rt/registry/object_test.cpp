// What is remarked on boxes that do not meet the mesh.

#include "rt/registry/object.hpp"

#include <gtest/gtest.h>

namespace palpate::registry {
namespace {

/// Remarks on a block of 0.2 m in five cells along each edge, with nodes every 20 mm.
std::vector<std::string> remarks_on(const std::string& boxes) {
  const config::Node root = config::Node::from_text(R"(object:
  mesh: {box: {size: [0.2, 0.2, 0.2], cells: [5, 5, 5]}}
  material: {young_modulus: 30e3, poisson_ratio: 0.3, density: 26}
)" + boxes,
                                                    "block.yaml");
  std::vector<std::string> remarks;
  read_object(root, Frames(), &remarks);
  return remarks;
}

TEST(Object, ABoundBetweenRowsOfNodesIsRemarkedWithBothPlaces) {
  const std::vector<std::string> remarks = remarks_on(
      "  fixed_box: {lower: [0, 0, 0], upper: [0, 0.2, 0.2]}\n"
      "  grasp_box: {lower: [0.1667, 0, 0], upper: [0.2, 0.2, 0.2]}\n");
  ASSERT_EQ(remarks.size(), 1u);
  for (const char* part : {"object.grasp_box.lower", "x = 0.1667 m", "x = 0.18 m", "x = 0.16 m"})
    EXPECT_NE(remarks[0].find(part), std::string::npos) << part << " in " << remarks[0];
}

TEST(Object, EveryBoundOfEveryBoxIsLookedAt) {
  const std::vector<std::string> remarks = remarks_on(
      "  fixed_box: {lower: [0, 0.03, 0], upper: [0.01, 0.15, 0.2]}\n"
      "  grasp_box: {lower: [0.15, 0, 0], upper: [0.3, 0.3, 0.11]}\n");
  ASSERT_EQ(remarks.size(), 5u);
  EXPECT_EQ(remarks[0].find("object.fixed_box.upper: x = 0.01 m"), 0u) << remarks[0];
  EXPECT_NE(remarks[0].find("fixed nodes end at x = 0 m"), std::string::npos) << remarks[0];
  EXPECT_EQ(remarks[1].find("object.fixed_box.lower: y = 0.03 m"), 0u) << remarks[1];
  EXPECT_EQ(remarks[2].find("object.fixed_box.upper: y = 0.15 m"), 0u) << remarks[2];
  EXPECT_EQ(remarks[3].find("object.grasp_box.lower: x = 0.15 m"), 0u) << remarks[3];
  EXPECT_EQ(remarks[4].find("object.grasp_box.upper: z = 0.11 m"), 0u) << remarks[4];
}

TEST(Object, ABoundAtARowOfNodesOrBeyondTheBodyIsNotRemarked) {
  EXPECT_TRUE(remarks_on("  fixed_box: {lower: [-1, -1, -1], upper: [0.001, 1, 1]}\n"
                         "  grasp_box: {lower: [0.159, 0.02, 0], upper: [0.25, 0.1604, 0.2]}\n")
                  .empty());
}

}  // namespace
}  // namespace palpate::registry
