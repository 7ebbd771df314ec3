#include "core/kinematics/chain_dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::kinematics {
namespace {

using Eigen::Vector3d;

constexpr double kLength = 0.4, kGravity = 9.81;

Joint hinge(const char* name, double from) {
  Joint joint;
  joint.name = name;
  joint.X_PJ.translation() = Vector3d(from, 0, 0);
  joint.lower = -3;
  joint.upper = 3;
  joint.speed = 1;
  return joint;
}

BodyInertia rod(double mass, double center, double about_center) {
  BodyInertia at_center{mass, Vector3d::Zero(), about_center * Eigen::Matrix3d::Identity()};
  math::Pose X = math::Pose::Identity();
  X.translation() = Vector3d(center, 0, 0);
  return BodyInertia::moved(X, at_center);
}

// Two links in the vertical plane of x and y, gravity along -y.
ChainDynamics planar_arm() {
  return ChainDynamics({{hinge("a", 0), hinge("b", kLength)}, math::Pose::Identity()},
                       {rod(3, 0.2, 0.05), rod(2, 0.15, 0.03)}, {0, -kGravity, 0});
}

TEST(ChainDynamics, OfTwoLinksInAPlaneIsThatOfTextbooks) {
  const double a = 0.6, b = -1.1, da = 0.9, db = -1.7;
  ChainDynamics::State state;
  planar_arm().evaluate(Eigen::Vector2d(a, b), Eigen::Vector2d(da, db), state);
  // Siciliano et al., Robotics, 7.3.2
  const double coupled = 2 * kLength * 0.15;
  const double m22 = 0.03 + 2 * 0.15 * 0.15, m12 = m22 + coupled * std::cos(b);
  const double m11 = 0.05 + 3 * 0.2 * 0.2 + 2 * kLength * kLength + m22 + 2 * coupled * std::cos(b);
  EXPECT_NEAR(state.momentum[0], m11 * da + m12 * db, 1e-12);
  EXPECT_NEAR(state.momentum[1], m12 * da + m22 * db, 1e-12);
  // the matrix C of Christoffel symbols: [h db, h (da + db); -h da, 0]
  const double h = -coupled * std::sin(b);
  EXPECT_NEAR(state.coriolis[0], h * db * da - h * da * db, 1e-12);
  EXPECT_NEAR(state.coriolis[1], h * (da + db) * da, 1e-12);
  const double lower = 2 * 0.15 * kGravity * std::cos(a + b);
  EXPECT_NEAR(state.gravity[0], (3 * 0.2 + 2 * kLength) * kGravity * std::cos(a) + lower, 1e-12);
  EXPECT_NEAR(state.gravity[1], lower, 1e-12);
}

TEST(ChainDynamics, InertiaOfAMovedBodyIsThatOfItsPoints) {
  const Vector3d points[] = {{0.1, -0.2, 0.3}, {-0.3, 0.1, 0.05}, {0.2, 0.2, -0.1}};
  const math::Pose X_AB = math::make_pose(math::exp_rotation({0.3, -1, 0.4}), {0.5, -0.2, 0.1});
  BodyInertia in_A, in_B;
  for (const Vector3d& p : points) {
    const auto add = [](const Vector3d& r, BodyInertia& sum) {
      sum += {2, 2 * r, 2 * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose())};
    };
    add(p, in_B);
    add(X_AB * p, in_A);
  }
  const BodyInertia moved = BodyInertia::moved(X_AB, in_B);
  EXPECT_DOUBLE_EQ(moved.mass, in_A.mass);
  EXPECT_LT((moved.first_moment - in_A.first_moment).norm(), 1e-12);
  EXPECT_LT((moved.rotational - in_A.rotational).norm(), 1e-12);
}

TEST(ChainDynamics, DoesNotAllocate) {
  const ChainDynamics arm = planar_arm();
  const Eigen::Vector2d q(0.3, 0.4), dq(1, -1);
  ChainDynamics::State state;
  const loop::NoAllocationScope scope;
  arm.evaluate(q, dq, state);
  EXPECT_EQ(scope.count(), 0);
}

TEST(ChainDynamics, RefusesWhatCannotBe) {
  const SerialChain chain({hinge("a", 0)}, math::Pose::Identity());
  EXPECT_THROW(ChainDynamics(chain, {}, Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(ChainDynamics(chain, {rod(-1, 0, 0)}, Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(ChainDynamics(chain, {rod(1, NAN, 0)}, Vector3d::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::kinematics
