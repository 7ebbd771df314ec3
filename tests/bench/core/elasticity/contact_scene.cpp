#include "tests/bench/core/elasticity/contact_scene.hpp"

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::bench {

using Eigen::Vector3d;

ContactScene::ContactScene(bool table, double friction) {
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.2, 0.05, 0.05}, {9, 2, 2}),
                                      mesh::ElementOrder::kQuadratic);
  body.material = {1e5, 0.35, 300};
  body.gravity_O = {0, 0, -9.81};
  elasticity::GraspRegion grasp;
  for (int n = 0; n < body.mesh.node_count(); ++n) {
    if (body.mesh.nodes(0, n) > 0.2 - 1e-9) grasp.nodes.push_back(n);
    if (body.mesh.nodes(0, n) < 1e-9) body.fixed_nodes.push_back(n);
  }
  grasp.X_OG_rest.translation() = Vector3d(0.2, 0.025, 0.025);
  body.grasps = {grasp};
  if (!table) return;
  // ends short of the hand, which holds the bar above it
  obstacles = {{"table", collision::Box{{0.09, 0.2, 0.1}},
                math::make_pose(Eigen::Matrix3d::Identity(), {0.09, 0.025, -0.102}), friction}};
}

math::Pose ContactScene::hand(double t) const {
  const double press = 0.5 * (1 - std::cos(2 * t));
  math::Pose hand = body.grasps[0].X_OG_rest;
  hand.translation() += press * Vector3d(-0.006, 0.008 * std::sin(3 * t), -0.0018);
  hand.linear() = math::exp_rotation({0, -0.25 * press, 0.05 * std::sin(3 * t)});
  return hand;
}

}  // namespace palpate::bench
