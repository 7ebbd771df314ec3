#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>

#include "core/control/jacobian_providers.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const math::Pose kDisplaced =
    math::make_pose(math::exp_rotation({0.4, -0.3, 0.8}), Vector3d(0.45, 0.10, 0.02));

shape::PoseFeature::Options pose_points() {
  return {{Vector3d(0.20, 0.01, 0.02), Vector3d(0.27, 0.03, 0.05), Vector3d(0.23, 0.055, 0.01)}};
}

TEST(KinematicJacobian, OfAPointIsThatOfARigidBody) {
  support::RigidModel model(support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear));
  model.hold(0, kDisplaced);
  model.step(1e-3);
  shape::PointFeature feature(model.body().mesh, {{0.31, 0.02, 0.04}, {0, 1, 2}});
  VectorXd value(3);
  feature.evaluate(model.positions(), value);
  MatrixXd J(3, 6);
  ASSERT_TRUE(KinematicJacobian().update(feature, model, kDisplaced, J));
  Eigen::Matrix<double, 3, 6> expected;
  expected << Eigen::Matrix3d::Identity(), -math::cross_matrix(value - kDisplaced.translation());
  EXPECT_LT((J - expected).norm(), 1e-12);
}

TEST(KinematicJacobian, OfAPoseIsTheTwistTransform) {
  support::RigidModel model(support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear));
  model.hold(0, kDisplaced);
  model.step(1e-3);
  shape::PoseFeature feature(model.body().mesh, pose_points());
  VectorXd value(7);
  feature.evaluate(model.positions(), value);
  MatrixXd J(6, 6);
  ASSERT_TRUE(KinematicJacobian().update(feature, model, kDisplaced, J));
  math::Matrix6d expected = math::Matrix6d::Identity();
  expected.topRightCorner<3, 3>() = -math::cross_matrix(value.head<3>() - kDisplaced.translation());
  EXPECT_LT((J - expected).norm(), 1e-12);
}

TEST(FemJacobian, IsRefusedWithoutASensitivity) {
  support::RigidModel model(support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear));
  shape::PointFeature feature(model.body().mesh, {{0.31, 0.02, 0.04}, {0, 1, 2}});
  MatrixXd J(3, 6);
  FemJacobian provider({0});
  EXPECT_FALSE(provider.update(feature, model, kDisplaced, J));

  elasticity::Sensitivity& sensitivity = model.mutable_sensitivity();
  sensitivity.valid = true;  // but of a different size
  EXPECT_FALSE(provider.update(feature, model, kDisplaced, J));
  sensitivity.dx_dxi[0].setZero(3 * model.body().mesh.node_count(), 6);
  EXPECT_FALSE(provider.update(feature, model, kDisplaced, J)) << "nothing is held";
  model.hold(0, kDisplaced);
  EXPECT_TRUE(provider.update(feature, model, kDisplaced, J));
  sensitivity.dx_dxi[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(provider.update(feature, model, kDisplaced, J));
  EXPECT_THROW(FemJacobian({2}), std::invalid_argument);
}

/// Steps until it converges, executing every requested factorisation in place.
void settle(elasticity::DeformationModel& model) {
  for (int i = 0; i < 400; ++i) {
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    if (model.step(1e-3).status == elasticity::StepStatus::kConverged && i > 5) break;
  }
}

elasticity::SolverOptions precise() {
  elasticity::SolverOptions options;
  options.iterations = 6;
  options.tolerance = 1e-8;
  return options;
}

class FemJacobianOfBar : public ::testing::Test {
 protected:
  FemJacobianOfBar() : model_(body(), precise()) {
    model_.prepare();
    X_OG_ = model_.body().grasps[0].X_OG_rest;
    model_.hold(0, X_OG_);
    settle(model_);
    // Bend it, so that the tangent differs from that at rest.
    for (int i = 0; i < 40; ++i) {
      X_OG_.translation() += Vector3d(-0.5e-3, 0.5e-3, 2e-3);
      X_OG_.linear() = math::exp_rotation({0.005, -0.01, 0.005}) * X_OG_.linear();
      model_.hold(0, X_OG_);
      settle(model_);
    }
    refresh();
  }

  static elasticity::Body body() {
    return support::held_bar({6, 1, 1}, mesh::ElementOrder::kLinear);
  }

  /// A sensitivity of the current state, however little it has changed.
  void refresh() {
    for (int i = 0; i < 3; ++i) settle(model_);
    ASSERT_TRUE(model_.sensitivity().valid);
  }

  VectorXd value_at(shape::Feature& feature, const math::Pose& X_OG) {
    model_.hold(0, X_OG);
    settle(model_);
    VectorXd value(feature.value_count());
    feature.evaluate(model_.positions(), value);
    return value;
  }

  elasticity::CorotationalQuasistatic model_;
  math::Pose X_OG_;
};

TEST_F(FemJacobianOfBar, EqualsDifferencesOfSettledShapes) {
  shape::PoseFeature pose(model_.body().mesh, pose_points());
  shape::PointFeature point(model_.body().mesh, {{0.25, 0.03, 0.06}, {0, 1, 2}});
  shape::PointsFeature points(
      model_.body().mesh,
      {{{0.1, 0.03, 0.06}, {0.25, 0.03, 0.06}, {0.3, 0, 0.01}, {0.45, 0.06, 0.06}}});
  for (shape::Feature* feature : std::initializer_list<shape::Feature*>{&pose, &point, &points}) {
    const int dimension = feature->dimension();
    value_at(*feature, X_OG_);
    MatrixXd J(dimension, 6), numeric(dimension, 6);
    ASSERT_TRUE(FemJacobian({0}).update(*feature, model_, X_OG_, J));
    const double h = 1e-4;
    for (int k = 0; k < 6; ++k) {
      math::Vector6d xi = math::Vector6d::Unit(k) * h;
      const auto moved = [&](double sign) {
        math::Pose X = X_OG_;
        X.translation() += sign * xi.head<3>();
        X.linear() = math::exp_rotation(sign * xi.tail<3>()) * X.linear();
        return value_at(*feature, X);
      };
      const VectorXd ahead = moved(1), behind = moved(-1);
      VectorXd difference(dimension);
      feature->error(behind, ahead, difference);
      numeric.col(k) = difference / (2 * h);
    }
    const double relative = (J - numeric).norm() / numeric.norm();
    RecordProperty(feature->kind(), std::to_string(relative));
    // The loop may keep a factorisation until elements have rotated by 0.02 rad.
    EXPECT_LT(relative, 0.02) << J << "\n\n" << numeric;
  }
}

}  // namespace
}  // namespace palpate::control
