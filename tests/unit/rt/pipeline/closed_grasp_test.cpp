#include "rt/pipeline/closed_grasp.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rt/config/node.hpp"
#include "rt/pipeline/component_set.hpp"

namespace palpate::pipeline {
namespace {

using testing::HasSubstr;

config::Node cube(const std::vector<std::string>& overrides = {}) {
  return config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/cube_regrasp.yaml", overrides);
}

registry::Object object_of(const config::Node& root) {
  return registry::read_object(root, registry::read_frames(root));
}

math::Pose turned(const Eigen::Vector3d& p) {
  return math::make_pose(math::exp_rotation({0.3, -0.2, 0.5}), p);
}

TEST(FoundGrasp, IsWhatIsBetweenTheJawsOfTheMovedObject) {
  const config::Node root = cube();
  const registry::Object object = object_of(root);
  const Eigen::Matrix3Xd& rest = object.body.mesh.nodes;
  // The cube has been moved and turned; the hand is where it would be for the right half of it.
  const math::Pose motion = turned({0.1, -0.2, 0.05});
  const math::Pose X_OG =
      motion * math::make_pose(Eigen::Matrix3d::Identity(), {0.045, 0.03, 0.0525});
  const config::Node next =
      root.changed("object", found_grasp(object, {0, X_OG}, motion * rest), false, "grasp");
  const registry::Object held = object_of(next);
  ASSERT_EQ(held.body.mesh.nodes.cols(), rest.cols());
  std::vector<int> expected;
  for (int i = 0; i < rest.cols(); ++i)
    if (rest(0, i) > 0.045 - 0.031 && rest(2, i) > 0.0525 - 0.012) expected.push_back(i);
  EXPECT_EQ(held.body.grasps[0].nodes, expected);
  // At the hand's pose the model leaves the nodes where they are.
  const math::Pose follows = X_OG * held.body.grasps[0].X_OG_rest.inverse();
  for (const int node : expected) {
    const Eigen::Vector3d p = rest.col(node);
    EXPECT_LT((follows * p - motion * p).norm(), 1e-9);
  }
}

TEST(FoundGrasp, NeedsThreeNodesThatAreNotOnALine) {
  const registry::Object object = object_of(cube());
  const Eigen::Matrix3Xd& rest = object.body.mesh.nodes;
  const auto error_at = [&](const Eigen::Vector3d& place, const registry::Object& with) {
    try {
      found_grasp(with, {0, math::make_pose(Eigen::Matrix3d::Identity(), place)}, rest);
    } catch (const config::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_at({0.03, 0.03, 0.2}, object), HasSubstr("object.grasp_jaws: between the jaws "
                                                             "of the closed hand are 0 nodes"));
  registry::Object narrow = object;
  narrow.jaws[0] = registry::Box{{-0.1, -1e-4, -1e-4}, {0.1, 1e-4, 1e-4}};
  EXPECT_THAT(error_at({0.03, 0, 0}, narrow), HasSubstr("not on a line"));
  EXPECT_EQ(error_at({0.03, 0.03, 0.0525}, object), "");
}

}  // namespace
}  // namespace palpate::pipeline
