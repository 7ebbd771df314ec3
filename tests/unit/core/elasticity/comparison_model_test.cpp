#include "core/elasticity/comparison/comparison_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

// Common guarantees of the three comparison models.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kComparisonModelDt = 1e-3;  // s

/// A bar fixed at neither end, with a grasp at both.
Body two_handed_bar(mesh::ElementOrder order, const Material& material = {1e5, 0.25, 300}) {
  const int across = order == mesh::ElementOrder::kLinear ? 2 : 1;
  Body body = make_bar({0.2, 0.05, 0.05}, {3, across, across}, order, material);
  body.damping = {20, 0};
  GraspRegion other;
  other.nodes = body.fixed_nodes;
  other.X_OG_rest.translation() = Vector3d(0, 0.02, 0.03);
  body.fixed_nodes.clear();
  body.grasps.push_back(other);
  return body;
}

template <class M, mesh::ElementOrder kOrder>
struct Case {
  using Model = M;
  static constexpr mesh::ElementOrder order = kOrder;
};

template <class Case>
class ModelsForComparison : public testing::Test {};

using Cases = testing::Types<Case<LinearModel, mesh::ElementOrder::kLinear>,
                             Case<LinearModel, mesh::ElementOrder::kQuadratic>,
                             Case<MassSpringModel, mesh::ElementOrder::kLinear>,
                             Case<MassSpringModel, mesh::ElementOrder::kQuadratic>,
                             Case<ShapeMatchingModel, mesh::ElementOrder::kLinear>,
                             Case<ShapeMatchingModel, mesh::ElementOrder::kQuadratic>>;
TYPED_TEST_SUITE(ModelsForComparison, Cases, );  // clang counts the macro's arguments

void settle(DeformationModel& model, int steps = 3000) {
  for (int i = 0; i < steps; ++i)
    ASSERT_NE(model.step(kComparisonModelDt).status, StepStatus::kFailed);
}

TYPED_TEST(ModelsForComparison, ReactionsBalanceLoadsAndWeight) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const Body& body = model.body();
  for (int g : {0, 1}) model.hold(g, body.grasps[g].X_OG_rest);
  model.set_gravity({1, 2, -9.81});
  model.loads()(1, body.mesh.node_count() / 2) = 0.3;
  model.loads()(2, body.grasps[0].nodes[0]) =
      0.2;  // on a constrained node: enters the reaction only
  settle(model);
  const double mass = 300 * 0.2 * 0.05 * 0.05;
  const Vector3d applied = mass * Vector3d(1, 2, -9.81) + Vector3d(0, 0.3, 0.2);
  const Vector3d reaction = model.reaction(0).force + model.reaction(1).force;
  EXPECT_LT((reaction + applied).norm(), 1e-5 * applied.norm());
}

TYPED_TEST(ModelsForComparison, GraspsActAtOnce) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const Body& body = model.body();
  std::array<math::Pose, 2> X;
  for (int g : {0, 1}) {
    X[g] = body.grasps[g].X_OG_rest;
    X[g].linear() = rotation(0.1 - 0.2 * g, {1, 2, 3});
    X[g].translation() += Vector3d(0.002, -0.003, 0.001 * g);
  }
  const auto misplaced = [&](int g) {
    const math::Pose moved = X[g] * body.grasps[g].X_OG_rest.inverse();
    double largest = 0;
    for (int node : body.grasps[g].nodes) {
      const Vector3d off = model.positions().col(node) - moved * body.mesh.nodes.col(node);
      largest = std::max(largest, off.norm());
    }
    return largest;
  };
  for (const auto& [first, second] : {std::pair(true, false), std::pair(true, true),
                                      std::pair(false, true), std::pair(true, true)}) {
    for (const auto& [g, on] : {std::pair(0, first), std::pair(1, second)}) {
      on ? model.hold(g, X[g]) : model.release(g);
      EXPECT_EQ(model.is_held(g), on);
    }
    ASSERT_NE(model.step(kComparisonModelDt).status, StepStatus::kFailed);
    for (const auto& [g, on] : {std::pair(0, first), std::pair(1, second)}) {
      if (on) {
        EXPECT_LT(misplaced(g), 1e-12);
      } else {
        EXPECT_EQ(model.reaction(g).vector().norm(), 0);
      }
    }
  }
  EXPECT_GT(model.reaction(0).force.norm(), 0.01);
}

TYPED_TEST(ModelsForComparison, FixedNodesStay) {
  Body body = two_handed_bar(TypeParam::order);
  body.fixed_nodes = body.grasps[1].nodes;
  body.grasps.pop_back();
  typename TypeParam::Model model(body);
  model.prepare();
  model.loads().row(2).setConstant(-0.01);
  settle(model, 50);
  EXPECT_LT(model.positions().row(2).minCoeff(), -1e-4);
  for (int node : body.fixed_nodes) {
    EXPECT_EQ(model.positions().col(node), body.mesh.nodes.col(node));
  }
}

TYPED_TEST(ModelsForComparison, WhatIsNotFiniteIsRefusedAndTheStateKept) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const math::Pose rest = model.body().grasps[0].X_OG_rest;
  model.hold(0, rest);
  model.set_gravity({0, 0, -9.81});
  settle(model, 20);
  const Matrix3Xd x = model.positions(), v = model.velocities();
  const math::Vector6d w = model.reaction(0).vector();
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto expect_refusal = [&](double dt) {
    EXPECT_EQ(model.step(dt).status, StepStatus::kFailed);
    EXPECT_EQ(model.positions(), x);
    EXPECT_EQ(model.velocities(), v);
    EXPECT_EQ(model.reaction(0).vector(), w);
  };
  for (double dt : {0.0, -1e-3, nan, inf}) expect_refusal(dt);
  for (double bad : {nan, inf}) {
    model.loads()(1, 2) = bad;
    expect_refusal(kComparisonModelDt);
    model.loads()(1, 2) = 0;
  }
  math::Pose X = rest;
  X.translation().y() = nan;
  model.hold(0, X);
  expect_refusal(kComparisonModelDt);
  model.hold(0, rest);
  model.set_gravity({nan, 0, 0});
  expect_refusal(kComparisonModelDt);
  model.set_gravity({0, 0, -9.81});
  EXPECT_NE(model.step(kComparisonModelDt).status, StepStatus::kFailed);
}

TYPED_TEST(ModelsForComparison, OverflowLeavesNothingBehind) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const math::Pose rest = model.body().grasps[0].X_OG_rest;
  model.hold(0, rest);
  for (double load : {1e160, 1e300, 1e308}) {
    model.loads()(1, 2) = load;
    model.loads()(1, 3) = -load;
    for (int i = 0; i < 3; ++i) model.step(kComparisonModelDt);
    EXPECT_TRUE(model.positions().allFinite());
    EXPECT_TRUE(model.velocities().allFinite());
    EXPECT_TRUE(model.reaction(0).vector().allFinite());
  }
  model.reset();
  model.hold(0, rest);
  EXPECT_EQ(model.step(kComparisonModelDt).status, StepStatus::kConverged);
  EXPECT_LT((model.positions() - model.body().mesh.nodes).norm(), 1e-12);
}

TYPED_TEST(ModelsForComparison, ResetBringsBackTheBeginningToTheBit) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const auto run = [&] {
    math::Pose X = model.body().grasps[0].X_OG_rest;
    for (int i = 0; i < 30; ++i) {
      X.translation().z() += 1e-4;
      X.linear() = rotation(0.01 * i, {1, 0, 1});
      model.hold(0, X);
      model.loads()(2, 3) = -0.02 * i;
      model.step(kComparisonModelDt);
    }
    return model.positions();
  };
  const Matrix3Xd first = run();
  model.reset();
  EXPECT_EQ(model.positions(), model.body().mesh.nodes);
  EXPECT_EQ(model.velocities().norm(), 0);
  EXPECT_EQ(model.loads().norm(), 0);
  EXPECT_FALSE(model.is_held(0));
  EXPECT_EQ(run(), first);
}

TYPED_TEST(ModelsForComparison, RestoreTakesAStateThatFits) {
  typename TypeParam::Model model(two_handed_bar(TypeParam::order));
  model.prepare();
  const Matrix3Xd rest = model.body().mesh.nodes, still = Matrix3Xd::Zero(3, rest.cols());
  Matrix3Xd bad = rest;
  bad(0, 0) = std::nan("");
  EXPECT_FALSE(model.restore(bad, still));
  EXPECT_FALSE(model.restore(rest, bad));
  EXPECT_FALSE(model.restore(rest.leftCols(3), still.leftCols(3)));
  EXPECT_EQ(model.positions(), rest);
  const Matrix3Xd moved = rest.colwise() + Vector3d(0.1, 0, 0);
  EXPECT_TRUE(model.restore(moved, still));
  EXPECT_EQ(model.positions(), moved);
}

// Loads up to a twentieth of E A in total, hands that shake, release and grasp again.
TYPED_TEST(ModelsForComparison, StormsOfLoadsAreSurvivedAtAnyModulus) {
  for (double modulus : {1e3, 1e5, 1e7}) {
    Body body = two_handed_bar(TypeParam::order, {modulus, 0.25, 300});
    body.damping.mass_factor = 0.12 * std::sqrt(modulus);  // about critical for bending
    typename TypeParam::Model model(body);
    model.prepare();
    const int n = body.mesh.node_count();
    const double load = 0.05 * modulus * 0.05 * 0.05 / n;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    model.hold(1, body.grasps[1].X_OG_rest);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
      if (i % 10 == 0) {
        for (int k = 0; k < n; ++k) {
          for (int axis = 0; axis < 3; ++axis) model.loads()(axis, k) = load * uniform(random);
        }
        math::Pose X = body.grasps[0].X_OG_rest;
        X.translation() += 0.002 * Vector3d(uniform(random), uniform(random), uniform(random));
        X.linear() = rotation(0.05 * uniform(random), {1, 1, 1});
        uniform(random) > 0 ? model.hold(0, X) : model.release(0);
      }
      refused += model.step(kComparisonModelDt).status == StepStatus::kFailed;
    }
    EXPECT_EQ(refused, 0) << modulus;
    const double moved = (model.positions() - body.mesh.nodes).colwise().norm().maxCoeff();
    EXPECT_LT(moved, 0.2) << modulus;
    model.loads().setZero();
    model.release(0);
    for (int i = 0; i < 2000; ++i) ASSERT_NE(model.step(5e-3).status, StepStatus::kFailed);
    const double left = (model.positions() - body.mesh.nodes).colwise().norm().maxCoeff();
    EXPECT_LT(left, 1e-5) << modulus;
  }
}

TEST(ModelsForComparison, InvalidBodiesAreRefused) {
  Body body = two_handed_bar(mesh::ElementOrder::kLinear);
  body.mesh.elements.col(2).head<2>().reverseInPlace();  // inverted
  EXPECT_THROW(LinearModel{body}, std::invalid_argument);
  EXPECT_THROW(MassSpringModel{body}, std::invalid_argument);
  EXPECT_THROW(ShapeMatchingModel{body}, std::invalid_argument);
  body = two_handed_bar(mesh::ElementOrder::kLinear);
  body.material.young_modulus = -1;
  EXPECT_THROW(LinearModel{body}, std::invalid_argument);
  EXPECT_THROW(MassSpringModel{body}, std::invalid_argument);
  EXPECT_THROW(ShapeMatchingModel{body}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity
