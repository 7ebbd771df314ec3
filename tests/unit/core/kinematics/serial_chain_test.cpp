#include "core/kinematics/serial_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::kinematics {
namespace {

using Eigen::Vector3d;

Joint joint(const char* name, const Vector3d& from, const Vector3d& axis) {
  Joint joint;
  joint.name = name;
  joint.X_PJ.translation() = from;
  joint.axis_J = axis;
  joint.lower = -3;
  joint.upper = 3;
  joint.speed = 1;
  return joint;
}

math::Pose shifted(const Vector3d& p) {
  math::Pose X = math::Pose::Identity();
  X.translation() = p;
  return X;
}

// Two links of 0.4 and 0.3 m in a plane: the textbook formula.
TEST(SerialChain, OfTwoLinksInAPlane) {
  const SerialChain chain({joint("a", {0, 0, 0.1}, {0, 0, 1}), joint("b", {0.4, 0, 0}, {0, 0, 1})},
                          shifted({0.3, 0, 0}));
  SerialChain::State state;
  const double a = 0.7, b = -1.1;
  chain.evaluate(Eigen::Vector2d(a, b), state);
  const Vector3d expected(0.4 * std::cos(a) + 0.3 * std::cos(a + b),
                          0.4 * std::sin(a) + 0.3 * std::sin(a + b), 0.1);
  EXPECT_LT((state.X_WE.translation() - expected).norm(), 1e-12);
  EXPECT_NEAR(std::atan2(state.X_WE.linear()(1, 0), state.X_WE.linear()(0, 0)), a + b, 1e-12);
  EXPECT_NEAR(state.J_W_E(0, 0), -expected.y(), 1e-12);
  EXPECT_NEAR(state.J_W_E(1, 0), expected.x(), 1e-12);
  EXPECT_NEAR(state.J_W_E(0, 1), -0.3 * std::sin(a + b), 1e-12);
  EXPECT_NEAR(state.J_W_E(5, 0), 1, 1e-12);
}

TEST(SerialChain, JacobianIsThatOfCentralDifferences) {
  std::vector<Joint> joints = {joint("a", {0, 0, 0.3}, {0, 0, 1}),
                               joint("b", {0.1, 0, 0.2}, {0, 1, 0}),
                               joint("slide", {0, 0.1, 0.2}, Vector3d(1, 2, 2) / 3),
                               joint("c", {0, 0, 0.4}, Vector3d(2, -1, 2) / 3)};
  joints[1].X_PJ.linear() = math::exp_rotation({0.3, -0.2, 1});
  joints[2].revolute = false;
  math::Pose X_JE = shifted({0.05, 0, 0.1});
  X_JE.linear() = math::exp_rotation({1, 0.4, 0});
  const SerialChain chain(joints, X_JE);
  const Eigen::Vector4d q(0.3, -0.8, 0.2, 1.4);
  SerialChain::State at, plus, minus;
  chain.evaluate(q, at);
  for (int i = 0; i < 4; ++i) {
    const double h = 1e-6;
    const Eigen::Vector4d step = h * Eigen::Vector4d::Unit(i);
    chain.evaluate(q + step, plus);
    chain.evaluate(q - step, minus);
    const Vector3d v = (plus.X_WE.translation() - minus.X_WE.translation()) / (2 * h);
    const Vector3d w =
        math::log_rotation(plus.X_WE.linear() * minus.X_WE.linear().transpose()) / (2 * h);
    EXPECT_LT((at.J_W_E.col(i).head<3>() - v).norm(), 1e-8) << i;
    EXPECT_LT((at.J_W_E.col(i).tail<3>() - w).norm(), 1e-8) << i;
  }
  const loop::NoAllocationScope scope;
  chain.evaluate(q, at);
  EXPECT_EQ(scope.count(), 0);
}

TEST(SerialChain, RefusesJointsThatCannotBe) {
  const auto with = [](auto change) {
    std::vector<Joint> joints = {joint("a", {0, 0, 0}, {0, 0, 1})};
    change(joints);
    SerialChain(joints, math::Pose::Identity());
  };
  using Joints = std::vector<Joint>;
  EXPECT_NO_THROW(with([](Joints&) {}));
  EXPECT_THROW(with([](Joints& j) { j.clear(); }), std::invalid_argument);
  EXPECT_THROW(with([](Joints& j) { j.resize(17, j[0]); }), std::invalid_argument);
  EXPECT_THROW(with([](Joints& j) { j[0].axis_J *= 2; }), std::invalid_argument);
  EXPECT_THROW(with([](Joints& j) { j[0].lower = 4; }), std::invalid_argument);
  EXPECT_THROW(with([](Joints& j) { j[0].speed = 0; }), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::kinematics
