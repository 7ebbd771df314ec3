#include "core/contact/area_coordinates.hpp"

#include <gtest/gtest.h>

namespace palpate::contact {
namespace {

/// One triangle as a surface; a fourth node is far away and belongs to no triangle.
struct OneTriangle {
  OneTriangle() {
    mesh.corner_count = 4;
    mesh.nodes.resize(3, 4);
    mesh.nodes << 0, 2, 1, 1,  //
        0, 0, 1, 0,            //
        0, 0, 0, -9;
    surface.triangles.resize(3, 1);
    surface.triangles << 0, 1, 2;
    surface.nodes = {0, 1, 2};
    surface.triangle_nodes = {{0, 1, 2}};
  }
  mesh::ElementMesh mesh;
  mesh::Surface surface;
};

sensing::Contact force_at(const Eigen::Vector3d& location, const Eigen::Vector3d& force) {
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = location;
  contact.wrench.force = force;
  return contact;
}

ContactLoads distribute(ForceTransformer& transformer, const sensing::Contact& contact,
                        const Eigen::Matrix3Xd& positions) {
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, positions, loads);
  return loads;
}

TEST(AreaCoordinates, SharesTheThesisForceInThirds) {
  OneTriangle one;
  AreaCoordinates transformer(one.mesh, one.surface, {});
  const ContactLoads loads =
      distribute(transformer, force_at({1, 1.0 / 3, 0}, {3, 3, 3}), one.mesh.nodes);
  ASSERT_TRUE(loads.accepted);
  ASSERT_EQ(loads.loads.size(), 3u);
  for (const NodalLoad& load : loads.loads)
    EXPECT_LT((load.force - Eigen::Vector3d(1, 1, 1)).norm(), 1e-14) << "node " << load.node;
}

TEST(AreaCoordinates, GivesAllToTheVertexThatIsTouched) {
  OneTriangle one;
  AreaCoordinates transformer(one.mesh, one.surface, {});
  const ContactLoads loads =
      distribute(transformer, force_at({2, 0, 0}, {0, 0, -5}), one.mesh.nodes);
  ASSERT_TRUE(loads.accepted);
  for (const NodalLoad& load : loads.loads)
    EXPECT_NEAR(load.force.z(), load.node == 1 ? -5 : 0, 1e-14);
}

TEST(AreaCoordinates, RefusesWhatIsTooFarFromTheDeformedSurface) {
  OneTriangle one;
  AreaCoordinates transformer(one.mesh, one.surface, {});
  const Eigen::Vector3d touched(1, 0.3, 0.009);
  EXPECT_TRUE(distribute(transformer, force_at(touched, {0, 0, 1}), one.mesh.nodes).accepted);
  Eigen::Matrix3Xd moved = one.mesh.nodes;
  moved.row(2).array() -= 0.002;
  const ContactLoads loads = distribute(transformer, force_at(touched, {0, 0, 1}), moved);
  EXPECT_FALSE(loads.accepted);
  EXPECT_TRUE(loads.loads.empty());
}

TEST(AreaCoordinates, TakesAManualForceAtItsRestPoint) {
  OneTriangle one;
  AreaCoordinates transformer(one.mesh, one.surface, {});
  sensing::Contact contact = force_at({1, 1.0 / 3, 0}, {3, 0, 0});
  contact.source = sensing::Source::kManual;
  const Eigen::Matrix3Xd moved = one.mesh.nodes.colwise() + Eigen::Vector3d(5, 5, 5);
  EXPECT_TRUE(distribute(transformer, contact, moved).accepted);
}

TEST(AreaCoordinates, KeepsAGraspOnItsFixedPointsWhereverTheContactIs) {
  OneTriangle one;
  AreaCoordinates::Options options;
  options.fixed_rest_points = {{0, 0, 0}, {2, 0, 0}};
  AreaCoordinates transformer(one.mesh, one.surface, options);
  const ContactLoads loads =
      distribute(transformer, force_at({50, 0, 0}, {4, 0, 0}), one.mesh.nodes);
  ASSERT_TRUE(loads.accepted);
  Eigen::Vector3d by_node = Eigen::Vector3d::Zero();
  for (const NodalLoad& load : loads.loads) by_node[load.node] += load.force.x();
  EXPECT_LT((by_node - Eigen::Vector3d(2, 2, 0)).norm(), 1e-14);
}

TEST(AreaCoordinates, RefusesLoadsThatDoNotFitAndNumbersThatAreNotFinite) {
  OneTriangle one;
  AreaCoordinates transformer(one.mesh, one.surface, {});
  ContactLoads small;
  small.loads.reserve(2);
  transformer.distribute(force_at({1, 0.3, 0}, {0, 0, 1}), one.mesh.nodes, small);
  EXPECT_FALSE(small.accepted);
  EXPECT_TRUE(small.loads.empty());
  EXPECT_FALSE(
      distribute(transformer, force_at({1, 0.3, 0}, {0, NAN, 1}), one.mesh.nodes).accepted);
}

}  // namespace
}  // namespace palpate::contact
