#include "core/contact/wrench_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::contact {
namespace {

struct Box {
  explicit Box(mesh::ElementOrder order)
      : mesh(mesh::make_element_mesh(mesh::make_box({0.1, 0.1, 0.1}, {4, 4, 4}), order)),
        surface(mesh::extract_surface(mesh)) {}
  mesh::ElementMesh mesh;
  mesh::Surface surface;
};

math::Wrench sum(const ContactLoads& loads, const Eigen::Matrix3Xd& positions,
                 const Eigen::Vector3d& about) {
  math::Wrench total;
  for (const NodalLoad& load : loads.loads) {
    total.force += load.force;
    total.torque += (positions.col(load.node) - about).cross(load.force);
  }
  return total;
}

class WrenchPatchOnBox : public testing::TestWithParam<mesh::ElementOrder> {};

INSTANTIATE_TEST_SUITE_P(Orders, WrenchPatchOnBox,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(WrenchPatchOnBox, LoadsOnlyThePatch) {
  Box box(GetParam());
  WrenchPatch transformer(box.mesh, box.surface, {});
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = {0.05, 0.05, 0.1};
  contact.wrench.force = {0, 0, -2};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  ASSERT_TRUE(loads.accepted);
  for (const NodalLoad& load : loads.loads) {
    EXPECT_LT((box.mesh.nodes.col(load.node) - contact.location).norm(), 0.03);
    EXPECT_NEAR(box.mesh.nodes(2, load.node), 0.1, 1e-12);
    EXPECT_LE(load.force.z(), 0);  // a central force needs no tension
  }
}

TEST_P(WrenchPatchOnBox, WidensAPatchThatHoldsTooFewNodes) {
  Box box(GetParam());
  WrenchPatch::Options options;
  options.radius = 1e-4;
  WrenchPatch transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = {0.041, 0.056, 0.1};
  contact.wrench = {{0.3, 0, -2}, {0.01, 0.02, 0.03}};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  ASSERT_TRUE(loads.accepted);
  const math::Wrench total = sum(loads, box.mesh.nodes, contact.location);
  EXPECT_LT((total.vector() - contact.wrench.vector()).norm(), 1e-12);
}

TEST_P(WrenchPatchOnBox, LoadsFixedNodesForAContactInsideTheObject) {
  Box box(GetParam());
  WrenchPatch::Options options;
  options.fixed_nodes = mesh::nodes_in_box(box.mesh, {0.1, 0, 0}, {0.1, 0.1, 0.1});
  options.fixed_reference = {0.05, 0.05, 0.05};  // 50 mm below the surface
  WrenchPatch transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kWrist0;
  contact.location = {0.3, -0.1, 0.2};  // the hand's reported position does not count
  contact.wrench = {{1, 2, 3}, {0.1, -0.2, 0.3}};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  ASSERT_TRUE(loads.accepted);
  for (const NodalLoad& load : loads.loads) EXPECT_NEAR(box.mesh.nodes(0, load.node), 0.1, 1e-12);
  const math::Wrench total = sum(loads, box.mesh.nodes, options.fixed_reference);
  EXPECT_LT((total.vector() - contact.wrench.vector()).norm(), 1e-12);
}

/// The reference point of a fixed patch is a material one: it moves with the mesh.
TEST_P(WrenchPatchOnBox, ReferenceOfFixedNodesMovesWithTheMesh) {
  Box box(GetParam());
  WrenchPatch::Options options;
  options.fixed_nodes = mesh::nodes_in_box(box.mesh, {0.1, 0, 0}, {0.1, 0.1, 0.1});
  options.fixed_reference = {0.09, 0.05, 0.05};
  WrenchPatch transformer(box.mesh, box.surface, options);
  const math::Pose X = math::make_pose(math::exp_rotation({0.3, -0.2, 0.5}), {0.2, 0.1, -0.3});
  const Eigen::Matrix3Xd positions = X * box.mesh.nodes;
  sensing::Contact contact;
  contact.source = sensing::Source::kWrist0;
  contact.wrench = {{1, 2, 3}, {0.1, -0.2, 0.3}};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, positions, loads);
  ASSERT_TRUE(loads.accepted);
  const math::Wrench total = sum(loads, positions, X * options.fixed_reference);
  EXPECT_LT((total.vector() - contact.wrench.vector()).norm(), 1e-12);
}

/// A whole face under uniform pressure does the work of its mean square lever, side^2 / 12, under a
/// displacement that grows with the square; linear triangles add their interpolation error.
TEST_P(WrenchPatchOnBox, EqualsUniformPressureOnAFace) {
  Box box(GetParam());
  WrenchPatch::Options options;
  for (const int node : mesh::nodes_in_box(box.mesh, {0, 0, 0.1}, {0.1, 0.1, 0.1}))
    options.fixed_nodes.push_back(node);
  options.fixed_reference = {0.05, 0.05, 0.1};
  WrenchPatch transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = {0.05, 0.05, 0.1};
  contact.wrench.force = {0, 0, -1};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  ASSERT_TRUE(loads.accepted);
  double second_moment = 0;
  for (const NodalLoad& load : loads.loads)
    second_moment -= load.force.z() * std::pow(box.mesh.nodes(0, load.node) - 0.05, 2);
  const bool quadratic = GetParam() == mesh::ElementOrder::kQuadratic;
  EXPECT_NEAR(second_moment, 0.01 / 12 + (quadratic ? 0 : 0.025 * 0.025 / 6), 1e-12);
}

TEST(WrenchPatch, RefusesNodesOnOneLine) {
  Box box(mesh::ElementOrder::kLinear);
  WrenchPatch::Options options;
  options.fixed_nodes = mesh::nodes_in_box(box.mesh, {0, 0, 0}, {0.1, 0, 0});
  WrenchPatch transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kWrist0;
  contact.wrench.torque = {1, 0, 0};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  EXPECT_FALSE(loads.accepted);
  EXPECT_TRUE(loads.loads.empty());
}

TEST(WrenchPatch, RefusesAContactAwayFromTheSurface) {
  Box box(mesh::ElementOrder::kLinear);
  WrenchPatch transformer(box.mesh, box.surface, {});
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = {0.05, 0.05, 0.12};
  contact.wrench.force = {0, 0, -1};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.mesh.nodes, loads);
  EXPECT_FALSE(loads.accepted);
}

}  // namespace
}  // namespace palpate::contact
