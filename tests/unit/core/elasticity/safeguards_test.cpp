#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "tests/unit/core/elasticity/elements.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

// Safeguards that keep the co-rotational model bounded for any input.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

double total_energy(const Body& body, const CorotationalModel& model) {
  const double elastic = Elements(body).evaluate(model.positions()).energy;
  double kinetic = 0;
  Eigen::MatrixXd m;
  for (int e = 0; e < model.elements().element_count(); ++e) {
    model.elements().mass(e, m);
    const Eigen::VectorXi nodes = body.mesh.elements.col(e);
    const Eigen::MatrixXd v = model.velocities()(Eigen::all, nodes);
    kinetic += 0.5 * (v * m).cwiseProduct(v).sum();
  }
  return elastic + kinetic;
}

class StiffAndSoft : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(YoungModulus, StiffAndSoft, testing::Values(1e3, 1e5, 1e7, 1e9));

// Hit far harder than two corrections can follow, with one factorisation throughout.
TEST_P(StiffAndSoft, EnergyNeverRisesWithoutForces) {
  Body body = make_bar({0.2, 0.05, 0.05}, {5, 1, 1}, mesh::ElementOrder::kQuadratic,
                       {GetParam(), 0.35, 300});
  body.damping = {0.5, 0};
  CorotationalDynamic model(body);
  model.prepare();
  std::srand(3);
  const Matrix3Xd v = 20 * Matrix3Xd::Random(3, body.mesh.node_count());
  ASSERT_TRUE(model.restore(body.mesh.nodes, v));
  const double first = total_energy(body, model);
  double last = first;
  for (int i = 0; i < 500; ++i) {
    ASSERT_NE(model.step(kDt).status, StepStatus::kFailed);
    const double now = total_energy(body, model);
    ASSERT_LE(now, last + 1e-9 * first) << "step " << i;
    last = now;
  }
  EXPECT_LT(last, 0.5 * first);
}

int ticks_of_clock = 0;
double counting_clock() { return 1e-4 * ticks_of_clock++; }

TEST(TimeBudget, EndsAStepAndKeepsTheBestState) {
  const Body body = bar();
  SolverOptions options;
  options.iterations = 50;
  options.tolerance = 1e-12;
  options.accuracy = 0;
  CorotationalQuasistatic free(body, options);
  options.clock = counting_clock;
  options.budget =
      2.5e-4;  // the clock is read once at the start of a step, then before each correction
  CorotationalQuasistatic hurried(body, options);
  for (auto* model : {&free, &hurried}) {
    model->prepare();
    model->loads() = face_load(body.mesh, 0.2, Vector3d(0, 0, -0.3));
  }
  EXPECT_GT(free.step(kDt).iterations, 5);
  const StepReport report = hurried.step(kDt);
  EXPECT_EQ(report.status, StepStatus::kNotConverged);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_LT(report.residual, 0.3);
  for (int i = 0; i < 100; ++i) hurried.step(kDt);
  EXPECT_LT((hurried.positions() - free.positions()).colwise().norm().maxCoeff(), 1e-6);
}

/// `x` with a few elements of make_bar({0.2, 0.05, 0.05}, {8, 2, 2}) inverted.
Matrix3Xd torn(Matrix3Xd x, const Body& body) {
  for (int node : nodes_at(body.mesh, 0, 0.1)) {
    if (body.mesh.nodes.col(node).tail<2>().isConstant(0.05)) x.col(node).tail<2>().setZero();
  }
  return x;
}

TEST(TornBody, KeepsTheStrainsThatItsHandAsksFor) {
  const Body body = make_bar({0.2, 0.05, 0.05}, {8, 2, 2}, mesh::ElementOrder::kLinear);
  CorotationalQuasistatic model(body);
  model.prepare();
  math::Pose pulled = body.grasps[0].X_OG_rest;
  Matrix3Xd before;
  for (int i = 0; i < 900; ++i) {
    pulled.translation().x() = 0.2 * (1 + std::min(0.6, 0.01 * i));
    model.hold(0, pulled);
    if (i == 300) {
      before = model.positions();
      ASSERT_TRUE(model.restore(torn(before, body), Matrix3Xd::Zero(3, before.cols())));
    }
    ASSERT_FALSE(model.step(kDt).restarted) << "step " << i;
    refactor(model);
  }
  EXPECT_LT((model.positions() - before).colwise().norm().maxCoeff(), 1e-6);
}

TEST(TornBody, GoesBackAsSlowlyAsItIsDamped) {
  Body body = make_bar({0.2, 0.05, 0.05}, {8, 2, 2}, mesh::ElementOrder::kLinear, {1e3, 0.3, 300});
  body.damping = {200, 0};  // about 1 s to recover
  CorotationalDynamic model(body);
  model.prepare();
  Matrix3Xd stretched = body.mesh.nodes;
  stretched.row(0) *= 1.6;
  ASSERT_TRUE(model.restore(torn(stretched, body), Matrix3Xd::Zero(3, stretched.cols())));
  for (int i = 0; i < 1000; ++i) {
    ASSERT_FALSE(model.step(kDt).restarted) << "step " << i;
    refactor(model);
    if (i == 200) {
      EXPECT_GT(model.positions().row(0).maxCoeff(), 1.4 * 0.2);
    }
  }
  EXPECT_LT(model.positions().row(0).maxCoeff(), 1.3 * 0.2);
}

// A rotation by 18 degrees in the other direction would fit the hand's pose with less energy.
TEST(TwistedBody, IsNotUntwisted) {
  const Body body = make_bar({0.4, 0.05, 0.05}, {16, 2, 2}, mesh::ElementOrder::kLinear);
  CorotationalQuasistatic model(body);
  model.prepare();
  for (int i = 0; i < 900; ++i) {
    math::Pose turned = body.grasps[0].X_OG_rest;
    turned.linear() = rotation(std::min(1.9 * M_PI, 0.01 * i), Vector3d::UnitX());
    model.hold(0, turned);
    ASSERT_FALSE(model.step(kDt).restarted) << "step " << i;
    refactor(model);
  }
  const double twist = 0.95 * M_PI;  // half way
  for (int node : nodes_at(body.mesh, 0, 0.2)) {
    const Vector3d arm = body.mesh.nodes.col(node) - Vector3d(0.2, 0.025, 0.025);
    const Vector3d now = model.positions().col(node) - Vector3d(0.2, 0.025, 0.025);
    EXPECT_LT((now - rotation(twist, Vector3d::UnitX()) * arm).norm(), 0.01);
  }
}

TEST(RigidBlend, CarriesARigidMotionAndFitsItsBoundary) {
  Body body = bar();
  const RigidBlend blend(body);
  const math::Pose motion = math::make_pose(rotation(0.5, {1, 0, 2}), Vector3d(0.1, 0, 0.02));
  for (int node : body.grasps[0].nodes) {
    EXPECT_LT(
        (blend.position(node, {true, false}, {motion, motion}) - motion * body.mesh.nodes.col(node))
            .norm(),
        1e-9);
  }
  for (int node : body.fixed_nodes) {
    EXPECT_LT(
        (blend.position(node, {true, false}, {motion, motion}) - body.mesh.nodes.col(node)).norm(),
        1e-9);
  }
  body.fixed_nodes.clear();
  const RigidBlend carried(body);
  for (int node = 0; node < body.mesh.node_count(); ++node) {
    EXPECT_LT((carried.position(node, {true, false}, {motion, motion}) -
               motion * body.mesh.nodes.col(node))
                  .norm(),
              1e-12);
  }
}

TEST(NodeWarp, TurnsByWhatHasHappenedSinceTheSnapshot) {
  const Eigen::Quaternionf then(Eigen::AngleAxisf(0.4f, Eigen::Vector3f(1, 2, 3).normalized()));
  const Eigen::Quaternionf since(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(-1, 0, 1).normalized()));
  const Eigen::Quaternionf more(Eigen::AngleAxisf(0.1f, Eigen::Vector3f::UnitX()));
  const auto column = [](const Eigen::Quaternionf& q) {
    return Eigen::Vector4f(q.w(), q.x(), q.y(), q.z());
  };
  Eigen::Matrix4Xf snapshot(4, 2), now(4, 2);
  snapshot << column(then), column(then);
  now << column(since * then), column(since * then);
  NodeWarp warp(2);
  warp.update(now, snapshot);
  EXPECT_NEAR(warp.largest(), 0.7, 1e-3);
  EXPECT_LT((warp.matrix(1) - since.toRotationMatrix()).norm(), 1e-6f);
  Eigen::VectorXf v = Eigen::VectorXf::Random(6);
  const Eigen::VectorXf before = v;
  warp.turn(v);
  EXPECT_LT((v.tail<3>() - since * before.tail<3>()).norm(), 1e-6f);
  warp.turn_back(v);
  EXPECT_LT((v - before).norm(), 1e-6f);
  now.col(1) = column(more * since * then);
  warp.update(now, snapshot);
  EXPECT_LT((warp.matrix(1) - (more * since).toRotationMatrix()).norm(), 1e-6f);
}

TEST(CorotationalDynamic, AFreeBodyKeepsItsLinearMomentum) {
  Body body = make_bar({0.1, 0.05, 0.05}, {2, 1, 1}, mesh::ElementOrder::kQuadratic);
  body.fixed_nodes.clear();
  body.damping = {0, 0.001};
  SolverOptions options;
  options.tolerance = 1e-11;
  options.accuracy = 0;
  options.iterations = 60;
  CorotationalDynamic model(body, options);
  model.prepare();
  std::srand(5);
  const Matrix3Xd v = 0.2 * Matrix3Xd::Random(3, body.mesh.node_count());
  ASSERT_TRUE(model.restore(body.mesh.nodes, v));
  const Eigen::VectorXd mass = model.elements().nodal_mass();
  const Vector3d momentum = v * mass;
  for (int i = 0; i < 200; ++i) {
    model.step(kDt);
    refactor(model);
  }
  EXPECT_LT((model.velocities() * mass - momentum).norm(), 1e-9 * v.norm() * mass.sum());
}

}  // namespace
}  // namespace palpate::elasticity
