#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/laws.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Shape = Eigen::VectorXd;

/// A bar under gravity and a load, its end in a hand that stretches, turns and bends it.
class HyperelasticModel : public testing::TestWithParam<std::tuple<mesh::ElementOrder, TestedLaw>> {
 protected:
  HyperelasticModel() {
    body_ = make_bar({0.12, 0.03, 0.03}, {4, 1, 1}, std::get<0>(GetParam()), {1e5, 0.4, 300});
    body_.law = std::get<1>(GetParam()).law();
    body_.gravity_O = Vector3d(0, 2, -9.81);
    hand_ = body_.grasps[0].X_OG_rest;
    hand_.translation() += Vector3d(0.03, 0.01, -0.02);
    hand_.linear() = rotation(0.7, {0.6, 0.8, 0.3});
    loads_ = Matrix3Xd::Zero(3, body_.mesh.node_count());
    loads_(1, body_.mesh.node_count() / 2) = 0.1;
    contact_ = mesh::PointLocator(body_.mesh).locate({0.05, 0.03, 0.02});
  }

  StaticSolution solve(const Body& body, const math::Pose& hand, const Matrix3Xd& loads,
                       const Matrix3Xd* start = nullptr) const {
    StaticOptions fine;
    fine.tolerance = 1e-11;
    StaticSolution solution = solve_static(body, loads, {hand, {}}, fine, start);
    EXPECT_TRUE(solution.converged);
    return solution;
  }

  Body body_;
  math::Pose hand_;
  Matrix3Xd loads_;
  mesh::PointWeights contact_;
};
INSTANTIATE_TEST_SUITE_P(
    All, HyperelasticModel,
    testing::Combine(testing::Values(mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic),
                     testing::ValuesIn(tested_laws())),
    [](const auto& test) {
      const bool linear = std::get<0>(test.param) == mesh::ElementOrder::kLinear;
      return (linear ? "linear_" : "quadratic_") + std::get<1>(test.param).name;
    });

TEST_P(HyperelasticModel, FollowsAHandToTheEquilibriumOfNewtonsMethod) {
  CorotationalQuasistatic model(body_);
  model.prepare();
  const math::Pose rest = body_.grasps[0].X_OG_rest;
  model.loads() = loads_;
  for (int k = 1; k <= 100; ++k) {
    math::Pose X = rest;
    X.translation() += k / 100.0 * (hand_.translation() - rest.translation());
    X.linear() = math::exp_rotation(k / 100.0 * math::log_rotation(hand_.linear()));
    model.hold(0, X);
    EXPECT_NE(model.step(kDt).status, StepStatus::kFailed);
    if (k % 5 == 0) refactor(model);
  }
  EXPECT_EQ(settle(model, true).status, StepStatus::kConverged);
  const StaticSolution exact = solve(body_, hand_, loads_, &model.positions());
  EXPECT_LT((model.positions() - exact.positions).cwiseAbs().maxCoeff(), 1e-6);
  const math::Vector6d w =
      patch_wrench(body_.grasps[0], hand_, exact.positions, exact.reactions).vector();
  EXPECT_LT((model.reaction(0).vector() - w).norm(), 1e-4 * w.norm());
  // the law matters here
  Body linear = body_;
  linear.law.reset();
  const Matrix3Xd other = solve(linear, hand_, loads_, &model.positions()).reactions;
  EXPECT_GT((other - exact.reactions).norm(), 0.03 * exact.reactions.norm());
}

TEST_P(HyperelasticModel, FreshSensitivitiesAreDifferencesOfEquilibria) {
  StaticSolver solver(body_);
  StaticOptions fine;
  fine.tolerance = 1e-11;
  const StaticSolution at = solver.solve(loads_, {hand_, {}}, fine);
  ASSERT_TRUE(at.converged);

  // the loop's own sensitivity, of a snapshot at this equilibrium
  CorotationalQuasistatic model(body_);
  model.prepare();
  model.watch_contact(0, contact_);
  model.restore(at.positions, Matrix3Xd::Zero(3, at.positions.cols()));
  model.hold(0, hand_);
  model.loads() = loads_;
  model.step(kDt);
  ASSERT_LT((model.positions() - at.positions).cwiseAbs().maxCoeff(), 1e-9);
  refactor(model);
  const Sensitivity& S = model.sensitivity();
  ASSERT_TRUE(S.valid);

  const auto expect_difference = [&](const auto& column, const auto& wrench, double h,
                                     const auto& moved, const char* what) {
    const auto answer = [&](double step) {
      Body body = body_;
      math::Pose hand = hand_;
      Matrix3Xd loads = loads_;
      moved(step, body, hand, loads);
      const StaticSolution s = solve(body, hand, loads, &at.positions);
      Shape x(s.positions.size() + 6);
      x << Eigen::Map<const Shape>(s.positions.data(), s.positions.size()),
          patch_wrench(body.grasps[0], hand, s.positions, s.reactions).vector();
      return x;
    };
    const Shape slope =
        (8 * (answer(h) - answer(-h)) - (answer(2 * h) - answer(-2 * h))) / (12 * h);
    const Eigen::Index n = at.positions.size();
    EXPECT_LT((column - slope.head(n)).norm(), 1e-5 * slope.head(n).norm()) << what;
    EXPECT_LT((wrench - slope.tail<6>()).norm(), 1e-5 * slope.tail<6>().norm()) << what;
  };
  using Loads = Matrix3Xd;
  for (const int k : {0, 4}) {
    expect_difference(
        S.dx_dxi[0].col(k), S.dw_dxi[0][0].col(k), k < 3 ? 1e-5 : 1e-3,
        [k](double h, Body&, math::Pose& hand, Loads&) {
          if (k < 3) hand.translation()[k] += h;
          if (k >= 3) hand.linear() = math::exp_rotation(h * Vector3d::Unit(k - 3)) * hand.linear();
        },
        "hand");
  }
  expect_difference(
      S.dx_dparameter.col(Sensitivity::kLogYoung), S.dw_dparameter[0].col(Sensitivity::kLogYoung),
      1e-3,
      [](double h, Body& body, math::Pose&, Loads&) { body.material.young_modulus *= std::exp(h); },
      "log E");
  expect_difference(
      S.dx_dparameter.col(Sensitivity::kPoisson), S.dw_dparameter[0].col(Sensitivity::kPoisson),
      1e-4, [](double h, Body& body, math::Pose&, Loads&) { body.material.poisson_ratio += h; },
      "nu");
  expect_difference(
      S.dx_dforce[0].col(2), S.dw_dforce[0][0].col(2), 1e-3,
      [&](double h, Body&, math::Pose&, Loads& loads) {
        for (int i = 0; i < contact_.count; ++i)
          loads(2, contact_.nodes[i]) += h * contact_.weights[i];
      },
      "force");
}

TEST_P(HyperelasticModel, DynamicOneComesToRestInTheSameEquilibrium) {
  body_.damping = {20, 0.02};
  CorotationalDynamic model(body_);
  model.prepare();
  model.hold(0, body_.grasps[0].X_OG_rest);
  model.set_gravity({0, 0, 0});
  model.loads().row(2).setConstant(-0.02);
  for (int k = 0; k < 600; ++k) {
    model.step(2e-3);
    if (k % 10 == 9) refactor(model);
  }
  body_.gravity_O.setZero();
  const Matrix3Xd exact =
      solve(body_, body_.grasps[0].X_OG_rest, model.loads(), &model.positions()).positions;
  EXPECT_GT((exact - body_.mesh.nodes).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((model.positions() - exact).cwiseAbs().maxCoeff(), 1e-6);
}

/// Mirrored through its clamp every element is inverted; the law's continuation drives it back.
TEST_P(HyperelasticModel, RecoversFromAMirroredShape) {
  body_.gravity_O.setZero();
  CorotationalDynamic model(body_);
  model.prepare();
  Matrix3Xd mirrored = body_.mesh.nodes;
  mirrored.row(0) *= -1;
  ASSERT_TRUE(model.restore(mirrored, Matrix3Xd::Zero(3, mirrored.cols())));
  for (int k = 0; k < 1500; ++k) {
    model.step(1e-3);
    if (k % 10 == 9) refactor(model);
  }
  EXPECT_TRUE(model.positions().allFinite());
  EXPECT_LT((model.positions() - body_.mesh.nodes).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace palpate::elasticity
