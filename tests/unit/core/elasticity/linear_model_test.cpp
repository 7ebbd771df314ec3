#include "core/elasticity/comparison/linear_model.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

class LinearModelOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  Body bar(const Material& material = {1e5, 0.35, 300}) const {
    return make_bar({0.2, 0.05, 0.04}, {4, 2, 1}, GetParam(), material);
  }
};

INSTANTIATE_TEST_SUITE_P(Orders, LinearModelOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(LinearModelOfEveryOrder, IsTheLinearStaticSolution) {
  Body body = bar();
  body.gravity_O = Vector3d(0, 3, -9.81);
  LinearModel model(body);
  model.prepare();
  const Matrix3Xd load = face_load(body.mesh, 0.2, Vector3d(2, 1, -3));
  model.loads() = load;
  const StepReport report = model.step(kDt);
  EXPECT_EQ(report.status, StepStatus::kConverged);
  EXPECT_LT(report.residual, 1e-9);
  const Matrix3Xd expected = solve_linear_statics(body, load);
  EXPECT_LT((model.positions() - body.mesh.nodes - expected).norm(), 1e-9 * expected.norm());
  EXPECT_EQ(model.velocities().norm(), 0);
}

TEST_P(LinearModelOfEveryOrder, StretchedByTheHandItPullsWithEAOverL) {
  const Body body = bar({1e5, 0, 300});
  LinearModel model(body);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation().x() += 0.01;
  model.hold(0, X);
  model.step(kDt);
  const double expected = 1e5 * 0.05 * 0.04 / 0.2 * 0.01;
  EXPECT_NEAR(model.reaction(0).force.x(), expected, 1e-9 * expected);
  EXPECT_LT(model.reaction(0).force.tail<2>().norm(), 1e-9 * expected);
  EXPECT_LT(model.reaction(0).torque.norm(), 1e-9 * expected);
}

// Springs in series: the halves of a bar of two moduli.
TEST_P(LinearModelOfEveryOrder, EachElementHasItsOwnModulus) {
  Body body = bar({1e5, 0, 300});
  body.element_materials.assign(body.mesh.element_count(), {1e5, 0, 300});
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    double middle = 0;
    for (int k = 0; k < 4; ++k) middle += body.mesh.nodes(0, body.mesh.elements(k, e)) / 4;
    if (middle > 0.1) body.element_materials[e].young_modulus = 4e5;
  }
  LinearModel model(body);
  model.prepare();
  model.loads() = face_load(body.mesh, 0.2, Vector3d(2, 0, 0));
  model.step(kDt);
  const double expected = 2 / (0.05 * 0.04) * (0.1 / 1e5 + 0.1 / 4e5);
  const double stretch = face_displacement(body.mesh, 0.2, model.positions()).x();
  EXPECT_NEAR(stretch, expected, 1e-9 * expected);
}

TEST_P(LinearModelOfEveryOrder, SensitivityIsThatOfCentralDifferences) {
  Body body = bar();
  GraspRegion middle;
  middle.nodes = nodes_at(body.mesh, 0, 0.1);
  middle.X_OG_rest.translation() = Vector3d(0.12, 0.01, 0);
  body.grasps.push_back(middle);
  LinearModel model(body);
  model.prepare();
  std::array<math::Pose, 2> X;
  for (int g : {0, 1}) {
    const math::Pose& rest = body.grasps[g].X_OG_rest;
    X[g] = math::make_pose(rotation(0.4 - 0.7 * g, {1, -2, 3}) * rest.linear(),
                           rest.translation() + Vector3d(0.01, 0.02 * g, -0.02));
    model.hold(g, X[g]);
  }
  model.set_gravity({0, 2, -9.81});
  model.loads()(1, body.mesh.node_count() / 2) = 0.5;
  model.loads()(2, body.grasps[0].nodes[0]) =
      0.2;  // on a constrained node: enters the reaction only
  model.step(kDt);
  ASSERT_TRUE(model.sensitivity().valid);
  EXPECT_EQ(model.sensitivity().age, 0);
  const Sensitivity s = model.sensitivity();

  for (int g : {0, 1}) {
    const auto at = [&](int column, double step) {
      math::Pose Y = X[g];
      if (column < 3) {
        Y.translation()(column) += step;
      } else {
        Y.linear() = math::exp_rotation(step * Vector3d::Unit(column - 3)) * X[g].linear();
      }
      model.hold(g, Y);
      model.step(kDt);
      model.hold(g, X[g]);
      return std::make_pair(
          model.positions(),
          std::array<math::Vector6d, 2>{model.reaction(0).vector(), model.reaction(1).vector()});
    };
    ASSERT_EQ(s.dx_dxi[g].rows(), 3 * body.mesh.node_count());
    for (int column = 0; column < 6; ++column) {
      const double h = 1e-5;
      const auto [x_plus, w_plus] = at(column, h);
      const auto [x_minus, w_minus] = at(column, -h);
      const Matrix3Xd dx = (x_plus - x_minus) / (2 * h);
      const Eigen::Map<const Matrix3Xd> predicted(s.dx_dxi[g].col(column).data(), 3, dx.cols());
      EXPECT_LT((dx - predicted).norm(), 1e-8 * dx.norm());
      for (int a : {0, 1}) {
        const math::Vector6d dw = (w_plus[a] - w_minus[a]) / (2 * h);
        EXPECT_LT((dw - s.dw_dxi[a][g].col(column)).norm(), 1e-8 * dw.norm());
      }
    }
  }
  model.release(0);
  EXPECT_FALSE(model.sensitivity().valid);
  model.step(kDt);
  EXPECT_TRUE(model.sensitivity().valid);
}

TEST(LinearModel, WithoutSupportItFailsUntilHeld) {
  Body body = make_bar({0.2, 0.05, 0.05}, {2, 1, 1}, mesh::ElementOrder::kLinear);
  body.fixed_nodes.clear();
  LinearModel model(body);
  model.prepare();
  model.set_gravity({0, 0, -9.81});
  EXPECT_EQ(model.step(kDt).status, StepStatus::kFailed);
  EXPECT_EQ(model.positions(), body.mesh.nodes);
  model.hold(0, body.grasps[0].X_OG_rest);
  EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged);
  const double weight = 300 * 0.2 * 0.05 * 0.05 * 9.81;
  EXPECT_NEAR(model.reaction(0).force.z(), weight, 1e-9 * weight);
}

}  // namespace
}  // namespace palpate::elasticity
