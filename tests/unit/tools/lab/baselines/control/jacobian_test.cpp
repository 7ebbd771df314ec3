// Jacobians that need no probes, compared with their theoretical limits and with differences.

#include <gtest/gtest.h>

#include <cmath>

#include "core/control/jacobian_providers.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/shape/point_features.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"
#include "tools/lab/baselines/control/constant_jacobian.hpp"
#include "tools/lab/baselines/control/difference_jacobian.hpp"
#include "tools/lab/baselines/control/diminishing_rigidity.hpp"
#include "tools/lab/baselines/control/geodesic.hpp"
#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

namespace palpate::baselines {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using support::HeldBarPlant;
using support::weightless_bar;

shape::PointFeature point_at(const elasticity::Body& body, double x) {
  return shape::PointFeature(body.mesh, {{x, 0.03, 0.06}, {0, 1, 2}});
}

TEST(Geodesic, IsTheWayAlongTheBar) {
  const elasticity::Body body = support::held_bar({10, 1, 1}, mesh::ElementOrder::kQuadratic);
  const std::vector<double> distance = geodesic_distances(body.mesh, body.grasps[0].nodes);
  for (int n = 0; n < body.mesh.node_count(); ++n)
    EXPECT_NEAR(distance[n], 0.5 - body.mesh.nodes(0, n), 1e-9) << n;
}

TEST(Geodesic, GoesRoundWhatIsNotThere) {
  // Two separate bars: no path leads from one to the other.
  elasticity::Body body = support::held_bar({2, 1, 1}, mesh::ElementOrder::kLinear);
  mesh::ElementMesh apart = body.mesh;
  const int n = body.mesh.node_count();
  apart.nodes.conservativeResize(3, 2 * n);
  apart.nodes.rightCols(n) = (body.mesh.nodes.colwise() + Vector3d(0, 1, 0)).eval();
  apart.elements.conservativeResize(4, 2 * body.mesh.element_count());
  apart.elements.rightCols(body.mesh.element_count()) = (body.mesh.elements.array() + n).matrix();
  const std::vector<double> distance = geodesic_distances(apart, {0});
  EXPECT_TRUE(std::isfinite(distance[n - 1]));
  EXPECT_TRUE(std::isinf(distance[n]));
}

TEST(DiminishingRigidity, WithoutDiminishingIsTheKinematicJacobian) {
  HeldBarPlant plant(weightless_bar());
  support::RigidModel model(plant.body());
  shape::PointFeature point = point_at(plant.body(), 0.25);
  const VectorXd value = plant.value(point);
  DiminishingRigidity provider({0, 0, 0}, plant.body(), 0);
  provider.observe(support::seen(plant, value, 1e-3));
  MatrixXd J(3, 6), rigid(3, 6);
  ASSERT_TRUE(provider.update(point, model, plant.X_OG(), J));
  ASSERT_TRUE(control::KinematicJacobian().update(point, model, plant.X_OG(), rigid));
  EXPECT_LT((J - rigid).norm(), 1e-12);
}

TEST(DiminishingRigidity, FallsOffWithTheDistanceFromTheHand) {
  HeldBarPlant plant(weightless_bar());
  support::RigidModel model(plant.body());
  DiminishingRigidity provider({4, 7, 0}, plant.body(), 0);
  for (const double x : {1.0 / 6, 0.25, 1.0 / 3, 0.5}) {
    shape::PointFeature point = point_at(plant.body(), x);
    const VectorXd value = plant.value(point);
    provider.observe(support::seen(plant, value, 1e-3));
    MatrixXd J(3, 6);
    ASSERT_TRUE(provider.update(point, model, plant.X_OG(), J));
    // Between nodes the weights are interpolated, which is slightly more than the exponential.
    const double share = std::exp(-4 * (0.5 - x));
    EXPECT_NEAR(J(0, 0), share, 0.02 * share) << x;
    EXPECT_NEAR(J(1, 1), J(0, 0), 1e-12);
    const Vector3d r = Vector3d(value) - plant.X_OG().translation();
    EXPECT_NEAR(J(0, 4), std::exp(-7 * (0.5 - x)) * r.z(), 0.1 * std::abs(r.z())) << x;
  }
}

TEST(DirectionalRigidity, HandsOnAPullAndGivesWayUnderAPush) {
  HeldBarPlant plant(weightless_bar());
  support::RigidModel model(plant.body());
  shape::PointFeature point = point_at(plant.body(), 0.25);
  DiminishingRigidity provider({2, 2, 12}, plant.body(), 0);
  const auto along_bar = [&](double way) {
    provider.reset();
    math::Pose X = plant.X_OG();
    for (int i = 0; i < 3; ++i) {
      const VectorXd value = plant.value(point);
      provider.observe(support::seen(plant, value, 1e-3));
      X.translation().x() += way;
      plant.place(X);
    }
    MatrixXd J(3, 6);
    EXPECT_TRUE(provider.update(point, model, plant.X_OG(), J));
    return J(0, 0);
  };
  const double pull = along_bar(1e-3), push = along_bar(-1e-3);
  EXPECT_NEAR(pull, std::exp(-2 * 0.25), 0.02);
  EXPECT_LT(push, 0.6 * pull);
  EXPECT_THROW(DiminishingRigidity({-1, 1, 0}, plant.body(), 0), std::invalid_argument);
  EXPECT_THROW(DiminishingRigidity({1, 1, 0}, plant.body(), 1), std::invalid_argument);
}

TEST(CornerBody, KeepsWhatIsHeldAndFixed) {
  const elasticity::Body body = support::held_bar({4, 1, 1}, mesh::ElementOrder::kQuadratic);
  const elasticity::Body corners = corner_body(body);
  EXPECT_NO_THROW(corners.check());
  EXPECT_EQ(corners.mesh.node_count(), 20);
  EXPECT_EQ(corners.fixed_nodes.size(), 4u);
  EXPECT_EQ(corners.grasps[0].nodes.size(), 4u);
}

class OtherModels : public ::testing::Test {
 protected:
  /// Differences of the model's own equilibrium shapes.
  template <class Model, class... Options>
  MatrixXd numeric(shape::Feature& feature, const math::Pose& X_OG, double dt, Options... options) {
    const elasticity::Body corners = corner_body(body_);
    MatrixXd J(3, 6);
    const auto value_at = [&](const math::Pose& X) {
      Model model(corners, options...);
      model.prepare();
      model.set_gravity(corners.gravity_O);
      model.hold(0, X);
      for (int i = 0; i < 2000; ++i) model.step(dt);
      VectorXd value(3);
      feature.evaluate(model.positions(), value);
      return value;
    };
    const double h = 1e-3;
    for (int k = 0; k < 6; ++k) {
      math::Pose ahead = X_OG, behind = X_OG;
      const Vector3d axis = Vector3d::Unit(k % 3);
      for (auto [X, sign] : {std::pair{&ahead, 1.0}, std::pair{&behind, -1.0}}) {
        if (k < 3) X->translation() += sign * h * axis;
        if (k >= 3) X->linear() = math::exp_rotation(sign * h * axis) * X->linear();
      }
      J.col(k) = (value_at(ahead) - value_at(behind)) / (2 * h);
    }
    return J;
  }

  math::Pose bent() const {
    math::Pose X = body_.grasps[0].X_OG_rest;
    X.translation() += Vector3d(-0.02, 0.01, 0.06);
    X.linear() = math::exp_rotation({0.1, -0.3, 0.1}) * X.linear();
    return X;
  }

  elasticity::Body body_ = support::held_bar({6, 1, 1}, mesh::ElementOrder::kLinear);
  support::RigidModel model_{body_};
};

TEST_F(OtherModels, AsRigidAsPossibleIsThatOfItsOwnShapes) {
  DifferenceJacobian provider({}, body_, 0, [](const elasticity::Body& body) {
    return std::make_unique<AsRigidAsPossible>(body);
  });
  shape::PointFeature point = point_at(body_, 0.25);
  VectorXd value(3);
  point.evaluate(body_.mesh.nodes, value);
  provider.settle(bent(), 2000);
  MatrixXd J(3, 6);
  ASSERT_TRUE(provider.update(point, model_, bent(), J));
  const MatrixXd expected = numeric<AsRigidAsPossible>(point, bent(), 1e-3);
  EXPECT_LT((J - expected).norm() / expected.norm(), 0.05) << J << "\n\n" << expected;
}

TEST_F(OtherModels, MassSpringIsThatOfItsOwnShapes) {
  DifferenceJacobian::Options options;
  options.dt = 10;
  DifferenceJacobian provider(options, body_, 0, [](const elasticity::Body& body) {
    return std::make_unique<elasticity::MassSpringModel>(body);
  });
  shape::PointFeature point = point_at(body_, 0.25);
  VectorXd value(3);
  point.evaluate(body_.mesh.nodes, value);
  provider.settle(bent(), 100);
  MatrixXd J(3, 6);
  ASSERT_TRUE(provider.update(point, model_, bent(), J));
  const MatrixXd expected = numeric<elasticity::MassSpringModel>(point, bent(), 10);
  EXPECT_LT((J - expected).norm() / expected.norm(), 0.05) << J << "\n\n" << expected;
}

TEST_F(OtherModels, FollowTheHandInTurn) {
  DifferenceJacobian provider({}, body_, 0, [](const elasticity::Body& body) {
    return std::make_unique<AsRigidAsPossible>(body);
  });
  shape::PointFeature point = point_at(body_, 0.25);
  VectorXd value(3);
  point.evaluate(body_.mesh.nodes, value);
  MatrixXd J(3, 6), settled(3, 6);
  for (int i = 0; i < 7 * 1000; ++i) ASSERT_TRUE(provider.update(point, model_, bent(), J));
  provider.settle(bent(), 2000);
  ASSERT_TRUE(provider.update(point, model_, bent(), settled));
  EXPECT_LT((J - settled).norm() / settled.norm(), 0.02);
}

TEST_F(OtherModels, TheConstantOneStaysWhatItWasFirst) {
  shape::PointFeature point = point_at(body_, 0.25);
  VectorXd value(3);
  point.evaluate(body_.mesh.nodes, value);
  ConstantJacobian provider({0}, point);
  MatrixXd J(3, 6);
  EXPECT_FALSE(provider.update(point, model_, bent(), J)) << "nothing has been found off line";
  elasticity::Sensitivity& sensitivity = model_.mutable_sensitivity();
  model_.hold(0, bent());
  sensitivity.valid = true;
  sensitivity.dx_dxi[0].setConstant(3 * body_.mesh.node_count(), 6, 0.25);
  ASSERT_TRUE(provider.update(point, model_, bent(), J));
  EXPECT_LT((J.array() - 0.25).abs().maxCoeff(), 1e-12);
  sensitivity.dx_dxi[0].setConstant(0.75);
  ASSERT_TRUE(provider.update(point, model_, bent(), J));
  EXPECT_LT((J.array() - 0.25).abs().maxCoeff(), 1e-12);
  provider.reset();
  ASSERT_TRUE(provider.update(point, model_, bent(), J));
  EXPECT_LT((J.array() - 0.75).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace palpate::baselines
