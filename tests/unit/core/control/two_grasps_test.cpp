// Two grasps that move together: twelve columns.
#include <gtest/gtest.h>

#include "core/control/jacobian_providers.hpp"
#include "core/control/twist_law.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/math/random.hpp"
#include "core/shape/point_features.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector12d = Eigen::Matrix<double, 12, 1>;

constexpr double kLengthScale = 0.1;  // m

TwistLawOptions options_for(int grasps) {
  TwistLawOptions options;
  options.gain = 1;
  options.linear_speed = options.angular_speed = 1e3;
  options.dead_band = {0, 0};
  options.inverse = {kLengthScale, 0, 1e-4, grasps};
  return options;
}

elasticity::SolverOptions accurate() {
  elasticity::SolverOptions options;
  options.iterations = 6;
  options.tolerance = 1e-8;
  return options;
}

class TwoGraspsOfABar : public ::testing::Test {
 protected:
  TwoGraspsOfABar() : model_(support::bar_between_hands(mesh::ElementOrder::kLinear), accurate()) {
    model_.prepare();
    for (int g = 0; g < 2; ++g) X_OG_[g] = model_.body().grasps[g].X_OG_rest;
    for (int i = 0; i < 40; ++i) {
      X_OG_[0].translation() += Vector3d(-0.5e-3, 0.5e-3, 1e-3);
      X_OG_[1].linear() = math::exp_rotation({0.005, -0.005, 0}) * X_OG_[1].linear();
      settle();
    }
  }

  void settle() {
    for (int g = 0; g < 2; ++g) model_.hold(g, X_OG_[g]);
    for (int i = 0; i < 400; ++i) {
      if (elasticity::Refactorisation* job = model_.wanted_refactorisation()) {
        job->run();
        model_.install(*job);
      }
      if (model_.step(1e-3).status == elasticity::StepStatus::kConverged && i > 5) break;
    }
  }

  elasticity::CorotationalQuasistatic model_;
  std::array<math::Pose, 2> X_OG_;
};

TEST_F(TwoGraspsOfABar, JacobianEqualsDifferencesOfSettledShapes) {
  shape::PointFeature feature(model_.body().mesh, {{0.2, 0.03, 0.06}, {0, 1, 2}});
  const auto value = [&] {
    settle();
    VectorXd v(3);
    feature.evaluate(model_.positions(), v);
    return v;
  };
  value();
  FemJacobian::Options options;
  options.both = true;
  MatrixXd J(3, 12), numeric(3, 12);
  ASSERT_TRUE(FemJacobian(options).update(feature, model_, X_OG_[0], J));
  const auto at_rest = X_OG_;
  constexpr double kStep = 1e-4;
  for (int k = 0; k < 12; ++k) {
    const math::Vector6d xi = math::Vector6d::Unit(k % 6) * kStep;
    VectorXd moved[2];
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      X_OG_ = at_rest;
      math::Pose& X = X_OG_[k / 6];
      X.translation() += sign * xi.head<3>();
      X.linear() = math::exp_rotation(sign * xi.tail<3>()) * X.linear();
      moved[side] = value();
    }
    numeric.col(k) = (moved[0] - moved[1]) / (2 * kStep);
  }
  EXPECT_LT((J - numeric).norm() / numeric.norm(), 0.02) << J << "\n\n" << numeric;
  // Hands that move equally carry the whole bar along.
  const MatrixXd together = J.leftCols<3>() + J.middleCols<3>(6);
  EXPECT_LT((together - MatrixXd::Identity(3, 3)).norm(), 0.02);
}

TEST_F(TwoGraspsOfABar, NothingIsGivenWhileOneHandDoesNotHold) {
  shape::PointFeature feature(model_.body().mesh, {{0.2, 0.03, 0.06}, {0, 1, 2}});
  FemJacobian::Options options;
  options.both = true;
  MatrixXd J(3, 12);
  model_.release(1);
  EXPECT_FALSE(FemJacobian(options).update(feature, model_, X_OG_[0], J));
}

class TwoGraspLaw : public ::testing::Test {
 protected:
  LawOutput compute(ControlLaw& law, const VectorXd& error, const MatrixXd& J) {
    VectorXd zero = VectorXd::Zero(error.size());
    LawInputs inputs;
    inputs.value = inputs.target = &zero;
    inputs.error = &error;
    inputs.jacobian = &J;
    LawOutput output;
    output.unreachable.setZero(error.size());
    law.compute(inputs, output);
    return output;
  }

  elasticity::Body body_ = support::bar_between_hands(mesh::ElementOrder::kLinear);
  shape::PointFeature feature_{body_.mesh, {{0.25, 0.03, 0.06}, {0, 1, 2}}};
};

TEST_F(TwoGraspLaw, IsTheSmallestCommonMotionThatDoesIt) {
  ProportionalTwist law(options_for(2));
  law.configure_for(feature_);
  math::Random random(7);
  const auto normal = [&](auto, auto) { return random.normal(); };
  for (int trial = 0; trial < 50; ++trial) {
    const MatrixXd J = MatrixXd::NullaryExpr(3, 12, normal);
    const VectorXd error = MatrixXd::NullaryExpr(3, 1, normal);
    const LawOutput output = compute(law, error, J);
    Vector12d scale = Vector12d::Ones();
    scale.segment<3>(3).setConstant(1 / kLengthScale);
    scale.tail<3>().setConstant(1 / kLengthScale);
    const MatrixXd scaled = J * scale.asDiagonal();
    const VectorXd expected =
        scale.asDiagonal() * VectorXd(scaled.completeOrthogonalDecomposition().solve(error));
    Vector12d u;
    u << output.V_O_G.vector(), output.V_O_G_second.vector();
    EXPECT_LT((u - expected).norm(), 1e-6 * (1 + expected.norm()));
    EXPECT_LT((J * u - error).norm(), 1e-6 * (1 + error.norm()));
    EXPECT_LT(output.unreachable.norm(), 1e-6);
  }
}

TEST_F(TwoGraspLaw, SpeedLimitsScaleBothAlike) {
  TwistLawOptions options = options_for(2);
  ProportionalTwist fast(options);
  options.linear_speed = 0.02;
  ProportionalTwist slow(options);
  MatrixXd J(3, 12);
  J.setZero();
  J.leftCols<3>() = 0.8 * Eigen::Matrix3d::Identity();
  J.middleCols<3>(6) = 0.2 * Eigen::Matrix3d::Identity();
  const VectorXd error = Vector3d(0.3, -0.1, 0.2);
  fast.configure_for(feature_);
  slow.configure_for(feature_);
  const LawOutput free = compute(fast, error, J), limited = compute(slow, error, J);
  EXPECT_NEAR(limited.V_O_G.linear.norm(), 0.02, 1e-12);
  const double factor = limited.V_O_G.linear.norm() / free.V_O_G.linear.norm();
  EXPECT_LT(factor, 1);
  EXPECT_LT((limited.V_O_G_second.linear - factor * free.V_O_G_second.linear).norm(), 1e-12);
}

TEST_F(TwoGraspLaw, AJacobianOfAnotherSizeGivesNoMotion) {
  ProportionalTwist law(options_for(2));
  law.configure_for(feature_);
  const LawOutput output = compute(law, Vector3d(0.1, 0, 0), MatrixXd::Ones(3, 6));
  EXPECT_EQ(output.V_O_G.vector().norm(), 0);
  EXPECT_EQ(output.V_O_G_second.vector().norm(), 0);
  TwistLawOptions none = options_for(0);
  EXPECT_THROW(ProportionalTwist{none}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control
