// Learning from other motions: growing neural gas, the network, and both as an estimator.
#include "tools/lab/baselines/learning/learned_shape.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/lab/baselines/seen_bar.hpp"
#include "tools/lab/baselines/learning/neural_gas.hpp"

namespace palpate::baselines {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

// Fritzke 1994: the gas covers the support of the points, and its edges follow it.
TEST(NeuralGasTest, SpreadsOverACircle) {
  math::Random random(5);
  Eigen::Matrix3Xd points(3, 500);
  for (int i = 0; i < 500; ++i) {
    const double angle = random.uniform(0, 2 * M_PI);
    points.col(i) << std::cos(angle), std::sin(angle), 0;
  }
  NeuralGasOptions options;
  options.units = 20;
  options.rounds = 60;
  const NeuralGas gas = grow_neural_gas(points, options, random);
  ASSERT_EQ(gas.units.cols(), 20);
  double farthest = 0;
  for (int i = 0; i < 500; ++i)
    farthest = std::max(
        farthest, (gas.units.colwise() - Vector3d(points.col(i))).colwise().norm().minCoeff());
  EXPECT_LT(farthest, 0.35);  // uniformly distributed: 0.16
  EXPECT_GE(gas.edges.size(), 18u);
  for (const auto& [a, b] : gas.edges) {
    EXPECT_LT(a, b);
    EXPECT_LT((gas.units.col(a) - gas.units.col(b)).norm(), 1.0);
  }
  EXPECT_THROW(grow_neural_gas(points.leftCols(5), options, random), std::invalid_argument);
}

TEST(ShapeNetworkTest, LearnsASmoothFunction) {
  math::Random random(3);
  const auto sample = [&random](int count) {
    std::pair<MatrixXd, MatrixXd> s{MatrixXd(2, count), MatrixXd(2, count)};
    for (int i = 0; i < count; ++i) {
      const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
      s.first.col(i) << x, y;
      s.second.col(i) << 1e-2 * std::sin(2 * x) * y, 5 + x * x;
    }
    return s;
  };
  const auto [x, y] = sample(400);
  const auto [x_held, y_held] = sample(100);
  const ShapeNetwork net = train_shape_network(x, y, x_held, y_held, {}, random);
  net.check();
  Eigen::VectorXd room(net.hidden.rows()), result(2);
  const auto [x_new, y_new] = sample(100);
  MatrixXd off(2, 100);
  for (int i = 0; i < 100; ++i) {
    net.evaluate(x_new.col(i), room, result);
    off.col(i) = result - y_new.col(i);
  }
  EXPECT_LT(off.row(0).norm() / 10, 0.1 * y_new.row(0).norm() / 10);
  EXPECT_LT(off.row(1).norm() / 10, 0.05);
  EXPECT_THROW(train_shape_network(x, y.leftCols(3), x_held, y_held, {}, random),
               std::invalid_argument);
}

/// Trained on motions of a bar, it predicts another one.
TEST(LearnedShapeTest, RecognisesAShapeThatItWasNotTrainedOn) {
  const elasticity::Body body = support::held_bar({6, 1, 1}, mesh::ElementOrder::kLinear);
  const mesh::Surface surface = mesh::extract_surface(body.mesh);
  const Eigen::Matrix3Xd nodes = body.mesh.nodes(Eigen::all, surface.nodes);
  LearnedShape::Model model;
  NeuralGasOptions gas;
  gas.units = 10;
  model.units = grow_neural_gas(nodes, gas, math::Random(1)).units;
  math::Random random(9);
  support::SeenBar world(body);
  const mesh::PointLocator locator(world.model().body().mesh);
  estimation::EstimationInputs inputs;
  const int count = 60;
  MatrixXd x(6, count), y(30, count);
  Eigen::VectorXd input(6);
  const auto go = [&](const Vector3d& way) {
    const Vector3d from = world.hand.translation() - body.grasps[0].X_OG_rest.translation();
    for (int k = 1; k <= 60; ++k) {
      world.place(1, from + k / 60.0 * (way - from), Vector3d::Zero());
      world.tick(inputs);
    }
  };
  for (int i = 0; i < count; ++i) {
    const double reach = 0.06;
    go({random.uniform(-0.01, 0), random.uniform(-reach, reach), random.uniform(-reach, reach)});
    LearnedShape::gather(model.inputs, inputs.grasps[0].F_G_O.force, inputs.grasps[0].X_OG,
                         body.grasps[0].X_OG_rest, input);
    x.col(i) = input;
    for (int u = 0; u < 10; ++u)
      y.col(i).segment<3>(3 * u) =
          locator.locate(model.units.col(u)).interpolate(world.model().positions()) -
          model.units.col(u);
  }
  model.network = train_shape_network(x.leftCols(45), y.leftCols(45), x.rightCols(15),
                                      y.rightCols(15), {}, random);
  LearnedShape method(body, model, 0.02);
  support::Watcher watcher(body, 0, support::carrier(body), method);
  EXPECT_EQ(watcher.run(1.5, 0.7, {-0.005, 0.03, -0.04}, Vector3d::Zero()), 0);
  EXPECT_EQ(watcher.last.status, Status::kOk);
  const auto [mean, largest] = watcher.error();
  std::printf("mean %.2f mm, largest %.2f mm\n", mean * 1e3, largest * 1e3);
  EXPECT_LT(mean, 6e-3);
  watcher.inputs.grasps[0].wrench_valid = false;
  EXPECT_EQ(method.update(watcher.inputs, *watcher.model, watcher.estimate).status,
            Status::kDegraded);

  LearnedShape::Model wrong = model;
  wrong.inputs = LearnedShape::Inputs::kAngle;
  EXPECT_THROW(LearnedShape(body, wrong, 0.02), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines
