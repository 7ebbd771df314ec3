#include <gtest/gtest.h>

#include "core/elasticity/comparison/thesis2018.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/recorded_mesh.hpp"

// Regression values on the meshes of the 2018 system, of these solvers' own earlier runs, since the
// thesis prints none: hard foam, the face x = 0 fixed, a total force distributed equally over the
// nodes of the face x = max.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

struct LoadedBody {
  Body body;
  std::vector<int> tip;

  explicit LoadedBody(const std::string& name, double young_modulus = 3800) {
    body.mesh = mesh::make_element_mesh(thesis_mesh(name), mesh::ElementOrder::kLinear);
    body.material = {young_modulus, 0.15, 45};
    body.damping = {1.0, 0.01};
    body.fixed_nodes = nodes_at(body.mesh, 0, 0);
    tip = nodes_at(body.mesh, 0, body.mesh.nodes.row(0).maxCoeff());
  }
  Matrix3Xd load(const Vector3d& force) const {
    Matrix3Xd loads = Matrix3Xd::Zero(3, body.mesh.node_count());
    for (int node : tip) loads.col(node) = force / static_cast<double>(tip.size());
    return loads;
  }
  Vector3d tip_mean(const Matrix3Xd& displacements) const {
    Vector3d mean = Vector3d::Zero();
    for (int node : tip) mean += displacements.col(node) / static_cast<double>(tip.size());
    return mean;
  }
};

struct StaticCase {
  const char* mesh;
  double young_modulus;  // Pa
  int axis;
  double force;         // N
  double linear;        // mm, tip along the axis
  double corotational;  // mm
  double shortening;    // mm, u_x of the tip; 0: not recorded
};

class ThesisStatics : public testing::TestWithParam<StaticCase> {};

TEST_P(ThesisStatics, TipsAreThoseRecorded) {
  PALPATE_REQUIRE_RECORDING("thesis_meshes");
  const StaticCase& c = GetParam();
  const LoadedBody bar(c.mesh, c.young_modulus);
  const Matrix3Xd loads = bar.load(c.force * Vector3d::Unit(c.axis));
  // 0.1 %, or half of the last digit recorded.
  const auto tolerance = [](double value) { return std::max(1e-3 * std::abs(value), 0.5e-4); };

  const double linear = 1e3 * bar.tip_mean(solve_linear_statics(bar.body, loads))(c.axis);
  EXPECT_NEAR(linear, c.linear, tolerance(c.linear));
  const StaticSolution s = solve_static(bar.body, loads);
  ASSERT_TRUE(s.converged);
  const Vector3d tip = 1e3 * bar.tip_mean(s.positions - bar.body.mesh.nodes);
  EXPECT_NEAR(tip(c.axis), c.corotational, tolerance(c.corotational));
  if (c.shortening != 0) {
    EXPECT_NEAR(tip.x(), c.shortening, tolerance(c.shortening));
  }
  std::printf("%s E %g F%c %g N: linear %.4f mm, co-rotational %.4f mm, u_x %.4f mm\n", c.mesh,
              c.young_modulus, "xyz"[c.axis], c.force, linear, tip(c.axis), tip.x());

  CorotationalQuasistatic model(bar.body);
  model.prepare();
  model.loads() = loads;
  for (int i = 0; i < 100 && model.step(1e-3).status != StepStatus::kConverged; ++i) {
    if (Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
  }
  EXPECT_LT((model.positions() - s.positions).colwise().norm().maxCoeff(),
            2e-3 * (s.positions - bar.body.mesh.nodes).colwise().norm().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Recorded, ThesisStatics,
                         testing::Values(StaticCase{"bar", 3800, 2, 2e-3, 5.1467, 5.1437, -0.0762},
                                         StaticCase{"bar", 3800, 2, 20e-3, 51.467, 48.644, -6.934},
                                         StaticCase{"bar", 3800, 0, 2e-3, 0.0665, 0.0665, 0},
                                         StaticCase{"bar_long", 3800, 2, 1e-3, 7.8313, 7.8294, 0},
                                         StaticCase{"bar_long", 3800, 2, 10e-3, 78.313, 76.506,
                                                    -6.959},
                                         StaticCase{"bar_long", 3000, 2, 1e-3, 9.9196, 9.9158, 0},
                                         StaticCase{"block", 3800, 2, 0.1, 2.9379, 2.9378, 0},
                                         StaticCase{"block", 3800, 2, 1, 29.379, 29.318, 0},
                                         StaticCase{"block", 3800, 0, 0.1, 0.4558, 0.4557, 0},
                                         StaticCase{"cube", 3800, 2, 50e-3, 1.3149, 1.3147, 0},
                                         StaticCase{"cube", 3800, 0, 50e-3, 0.2375, 0.2374, 0},
                                         StaticCase{"sponge", 3800, 2, 5e-3, 3.643, 3.635, 0}));

struct StepResponse {
  const char* mesh;
  double force;                    // N, along z
  std::array<double, 5> recorded;  // mm, after 1, 10, 50, 100 and 200 steps
  double settling;                 // s, last time more than 5 % away from the end
  double settling_digit;           // s, last digit recorded
};

class ThesisStepResponse : public testing::TestWithParam<StepResponse> {};

TEST_P(ThesisStepResponse, IsTheRecordedOne) {
  PALPATE_REQUIRE_RECORDING("thesis_meshes");
  const StepResponse& c = GetParam();
  const LoadedBody bar(c.mesh);
  const Matrix3Xd loads = bar.load(Vector3d(0, 0, c.force));
  Thesis2018 model(bar.body);
  model.prepare();
  model.loads() = loads;
  std::vector<double> tip{0};
  for (int i = 1; i <= 500; ++i) {
    ASSERT_EQ(model.step(1e-3).status, StepStatus::kConverged);
    tip.push_back(1e3 * bar.tip_mean(model.positions() - bar.body.mesh.nodes).z());
  }
  constexpr int kSteps[] = {1, 10, 50, 100, 200};
  std::printf("%s:", c.mesh);
  for (int k = 0; k < 5; ++k) {
    std::printf(" %.3f", tip[kSteps[k]]);
    EXPECT_NEAR(tip[kSteps[k]], c.recorded[k], 0.5001e-3) << "after " << kSteps[k] << " steps";
  }
  int last_outside = 0;
  for (int i = 0; i <= 500; ++i) {
    if (std::abs(tip[i] / tip.back() - 1) > 0.05) last_outside = i;
  }
  std::printf(" mm, settled after %.2f s\n", last_outside * 0.02);
  EXPECT_NEAR(last_outside * 0.02, c.settling, 0.5001 * c.settling_digit);

  const StaticSolution s = solve_static(bar.body, loads);
  EXPECT_NEAR(tip.back(), 1e3 * bar.tip_mean(s.positions - bar.body.mesh.nodes).z(),
              0.02 * tip.back());
}

INSTANTIATE_TEST_SUITE_P(
    Recorded, ThesisStepResponse,
    testing::Values(StepResponse{"bar", 2e-3, {0.278, 6.188, 5.748, 5.092, 5.144}, 1.34, 0.01},
                    StepResponse{"bar_long", 1e-3, {0.052, 1.275, 10.461, 7.936, 8.561}, 4.3, 0.1},
                    StepResponse{"block", 0.1, {0.364, 4.109, 2.958, 2.939, 2.938}, 0.68, 0.01}));

TEST(Thesis2018, RefusesQuadraticMeshesAndKeepsItsStateWhenALoadIsNotANumber) {
  EXPECT_THROW(Thesis2018(make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kQuadratic)),
               std::invalid_argument);
  Thesis2018 model(make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kLinear));
  model.prepare();
  model.loads().setConstant(1e-3);
  model.step(1e-3);
  const Matrix3Xd x = model.positions();
  model.loads()(0, 0) = std::nan("");
  EXPECT_EQ(model.step(1e-3).status, StepStatus::kFailed);
  EXPECT_EQ(model.positions(), x);
}

TEST(Thesis2018, FollowsAHandAndFeelsIt) {
  Body body = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kLinear);
  Thesis2018 model(body);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation().z() += 0.01;
  model.hold(0, X);
  for (int i = 0; i < 1000; ++i) model.step(1e-3);
  const StaticSolution s = solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()), {X, {}});
  EXPECT_LT((model.positions() - s.positions).colwise().norm().maxCoeff(), 1e-6);
  const math::Wrench expected = patch_wrench(body.grasps[0], X, s.positions, s.reactions);
  EXPECT_LT((model.reaction(0).force - expected.force).norm(), 1e-4 * expected.force.norm());
  EXPECT_LT((model.reaction(0).torque - expected.torque).norm(), 1e-4 * expected.torque.norm());
}

}  // namespace
}  // namespace palpate::elasticity
