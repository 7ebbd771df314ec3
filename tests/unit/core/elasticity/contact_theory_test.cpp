// Contact with friction against closed solutions of beams and belts.
#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

/// A heavy strip on a table, one end of which is lifted by d without moment, leaves the table over
/// the length L = (24 EI d / q)^(1/4), and half the weight of that length hangs on the hand.
TEST(ContactTheory, AStripLiftedAtOneEndLeavesTheTableOverTheLengthOfABeam) {
  const double length = 0.22, width = 0.02, thickness = 0.004, d = 0.0024;
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({length, width, thickness}, {36, 1, 1}),
                                      mesh::ElementOrder::kQuadratic);
  body.material = {8e6, 0, 300};
  body.gravity_O = {0, 0, -kGravity};
  body.fixed_nodes = nodes_at(body.mesh, 0, 0);
  GraspRegion line;  // across the end, so that the hand exerts no bending moment
  for (int node : nodes_at(body.mesh, 0, length)) {
    if (std::abs(body.mesh.nodes(2, node) - thickness / 2) < 1e-9) line.nodes.push_back(node);
  }
  ASSERT_EQ(line.nodes.size(), 3u);
  line.X_OG_rest.translation() = Vector3d(length, width / 2, thickness / 2);
  body.grasps = {line};

  SolverOptions options = with_obstacles({plane(Vector3d::Zero(), {0, 0, 1}, 0)});
  options.contact.most = 320;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  math::Pose hand = line.X_OG_rest;
  model.hold(0, hand);
  run_steps(model, 10, 1);
  // the hand follows along the strip, which would otherwise be stretched
  const double along = 8e6 * width * thickness / length;  // N/m
  const int lifts = 40;
  for (int i = 1; i <= 2 * lifts; ++i) {
    hand.translation().z() = thickness / 2 + d * std::min(i, lifts) / lifts;
    hand.translation().x() -= model.reaction(0).force.x() / along;
    model.hold(0, hand);
    run_steps(model, 2, 2);
  }

  EXPECT_LT(std::abs(model.reaction(0).force.x()), 1e-3);
  const double EI = 8e6 * width * std::pow(thickness, 3) / 12;
  const double q = 300 * kGravity * width * thickness;
  const double L = std::pow(24 * EI * d / q, 0.25);
  double touched_to = 0;
  for (const SurfaceContact& contact : model.contacts()) {
    if (contact.force.norm() > 1e-3 * q * L)
      touched_to = std::max(touched_to, contact.position.x());
  }
  EXPECT_NEAR(length - touched_to, L, 0.05 * L);
  EXPECT_NEAR(model.reaction(0).force.z(), q * L / 2, 0.05 * q * L / 2);
  EXPECT_LT(deepest(model), 2e-3 * thickness);
}

/// A belt that slides on a cylinder: the tensions at its ends have the ratio exp(friction * angle).
TEST(ContactTheory, ABeltRoundACylinderFollowsEulerAndEytelwein) {
  const double R = 0.05, thickness = R / 20, width = 0.01, length = 0.16, before = 0.02;
  const double mu = 0.3, wrapped = M_PI / 2, pull = 0.004;
  Body body = make_bar({length, width, thickness}, {48, 1, 1}, mesh::ElementOrder::kQuadratic,
                       {1e6, 0.3, 300});
  SolverOptions options = with_obstacles({rod({before, width / 2, -R}, R, mu)});
  options.contact.most = 300;
  options.iterations = 4;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  const math::Pose rest = body.grasps[0].X_OG_rest;
  const int turns = 120, pulls = 60;
  for (int i = 0; i <= turns + pulls; ++i) {
    const double angle = wrapped * std::min(i, turns) / turns;
    const double pulled = 2e-4 + pull * std::max(0, i - turns) / pulls;
    const Vector3d along(std::cos(angle), 0, -std::sin(angle));
    const Vector3d out(std::sin(angle), 0, std::cos(angle));
    math::Pose hand = rest;
    hand.linear() = rotation(angle, Vector3d::UnitY());
    hand.translation() = Vector3d(before, width / 2, -R) + (R + thickness / 2) * out +
                         (length - before - (R + thickness / 2) * angle + pulled) * along;
    model.hold(0, hand);
    run_steps(model, 2, 4);
  }
  run_steps(model, 50, 10);

  const Vector3d hand_force = model.reaction(0).force, on_belt = contact_force(model);
  const double pulled_side = hand_force.dot(Vector3d(0, 0, -1));
  const double fixed_side = (hand_force + on_belt).x();
  double from = 10, to = -10;
  int at_limit = 0, pressing = 0;  // sliding has brought friction to its limit, where it rests
  for (const SurfaceContact& contact : model.contacts()) {
    if (contact.force.norm() < 1e-4 * pulled_side) continue;
    const double angle = std::atan2(contact.normal.x(), contact.normal.z());
    from = std::min(from, angle);
    to = std::max(to, angle);
    ++pressing;
    const double normal_force = contact.normal_force();
    const double friction = (contact.force - normal_force * contact.normal).norm();
    at_limit += friction > 0.99 * mu * normal_force;
  }
  EXPECT_GT(at_limit, 0.9 * pressing);
  EXPECT_NEAR(to - from, wrapped, 0.15);  // its bending stiffness lifts it off at the ends
  EXPECT_NEAR(pulled_side / fixed_side, std::exp(mu * (to - from)),
              0.05 * std::exp(mu * (to - from)));
  EXPECT_LT(deepest(model), 2e-3 * thickness);
}

}  // namespace
}  // namespace palpate::elasticity
