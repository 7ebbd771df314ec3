#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/recorded_mesh.hpp"

// Rows of `baseline_on_delivered_meshes`: an independent code on the same meshes.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Linear elements have one answer. That of quadratic ones depends on the quadrature, since there
/// is one rotation per point; ours has four, the baseline's is not stated. It differs by some 1e-4.
double tolerance(const std::string& row) { return row.substr(0, 2) == "P1" ? 1e-6 : 3e-4; }

nlohmann::json baseline(const std::string& name, const std::string& row) {
  std::ifstream in(support::recordings() / "fem_cases" / name / "summary.json");
  return nlohmann::json::parse(in).at("baseline_on_delivered_meshes").at(row);
}

Vector3d vector(const nlohmann::json& values) {
  return {values.at(0).get<double>(), values.at(1).get<double>(), values.at(2).get<double>()};
}

Body case_body(const std::string& name, const std::string& row, double length,
               const Material& material) {
  Body body;
  body.mesh = mesh::make_element_mesh(
      case_mesh(name, row.substr(3)),
      row.substr(0, 2) == "P1" ? mesh::ElementOrder::kLinear : mesh::ElementOrder::kQuadratic);
  body.material = material;
  body.fixed_nodes = nodes_at(body.mesh, 0, 0);
  GraspRegion grasp;
  grasp.nodes = nodes_at(body.mesh, 0, length);
  body.grasps = {grasp};
  return body;
}

struct TractionCase {
  const char* name;
  const char* row;
  double length;
  Material material;
  Vector3d force;
  Vector3d gravity;
};

class TractionCases : public testing::TestWithParam<TractionCase> {};

TEST_P(TractionCases, MeanDisplacementOfTheLoadedFaceIsThatOfTheBaseline) {
  PALPATE_REQUIRE_RECORDING("fem_cases");
  const TractionCase& c = GetParam();
  Body body = case_body(c.name, c.row, c.length, c.material);
  body.gravity_O = c.gravity;
  const StaticSolution s = solve_static(body, face_load(body.mesh, c.length, c.force));
  ASSERT_TRUE(s.converged);
  const nlohmann::json expected = baseline(c.name, c.row);
  EXPECT_EQ(body.mesh.node_count(), expected.at("nodes_fem").get<int>());
  const Vector3d mean = vector(expected.at("mean"));
  const Vector3d found = face_displacement(body.mesh, c.length, s.positions);
  std::printf("%s %s: %.3g of %.4f m off\n", c.name, c.row, (found - mean).norm(), mean.norm());
  EXPECT_LT((found - mean).norm(), tolerance(c.row) * mean.norm());
}

const Vector3d kNone = Vector3d::Zero(), kGravity(0, 0, -9.81);
const Material kRubber{1e5, 0.35, 1}, kFoam{30e3, 0.3, 26}, kGel{260e3, 0.49, 1070};

INSTANTIATE_TEST_SUITE_P(
    Rows, TractionCases,
    testing::Values(
        TractionCase{"bar_tip_1N", "P1_coarse", 0.2, kRubber, {0, 0, -1}, kNone},
        TractionCase{"bar_tip_1N", "P1_mid", 0.2, kRubber, {0, 0, -1}, kNone},
        TractionCase{"bar_tip_1N", "P2_coarse", 0.2, kRubber, {0, 0, -1}, kNone},
        TractionCase{"slender_gravity", "P1_coarse", 0.5, kFoam, {0, 0.05, 0}, kGravity},
        TractionCase{"slender_gravity", "P1_mid", 0.5, kFoam, {0, 0.05, 0}, kGravity},
        TractionCase{"slender_gravity", "P2_coarse", 0.5, kFoam, {0, 0.05, 0}, kGravity},
        TractionCase{"beam_nu049", "P1_coarse", 0.1, kGel, {0, 0, -0.5}, kGravity},
        TractionCase{"beam_nu049", "P1_mid", 0.1, kGel, {0, 0, -0.5}, kGravity},
        TractionCase{"beam_nu049", "P2_coarse", 0.1, kGel, {0, 0, -0.5}, kGravity}));

class GraspCases : public testing::TestWithParam<const char*> {};

TEST_P(GraspCases, ReactionWrenchIsThatOfTheBaseline) {
  PALPATE_REQUIRE_RECORDING("fem_cases");
  Body body = case_body("bar_grasp_motion", GetParam(), 0.2, kRubber);
  const Vector3d centre(0.2, 0.025, 0.025);
  body.grasps[0].X_OG_rest.translation() = centre;
  const math::Pose X = math::make_pose(rotation(25 * M_PI / 180, {0.6, 0.8, 0}),
                                       centre + Vector3d(-0.005, 0.006, -0.01));
  const StaticSolution s = solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()), {X, {}});
  ASSERT_TRUE(s.converged);
  const nlohmann::json expected = baseline("bar_grasp_motion", GetParam());
  const Vector3d force = vector(expected.at("force")), moment = vector(expected.at("moment"));
  const math::Wrench found = patch_wrench(body.grasps[0], X, s.positions, s.reactions);
  std::printf("bar_grasp_motion %s: %.3g N, %.3g N m off\n", GetParam(),
              (found.force - force).norm(), (found.torque - moment).norm());
  const double share = tolerance(GetParam());
  EXPECT_LT((found.force - force).norm(), share * force.norm());
  EXPECT_LT((found.torque - moment).norm(), share * moment.norm());

  // The incremental model, thrown there in one step, ends at the same place.
  CorotationalQuasistatic model(body);
  model.prepare();
  model.hold(0, X);
  for (int i = 0; i < 200; ++i) {
    if (Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    if (model.step(1e-3).status == StepStatus::kConverged) break;
  }
  EXPECT_LT((model.reaction(0).force - found.force).norm(), 1e-4 * force.norm());
  EXPECT_LT((model.reaction(0).torque - found.torque).norm(), 1e-4 * moment.norm());
}

INSTANTIATE_TEST_SUITE_P(Rows, GraspCases, testing::Values("P1_coarse", "P1_mid", "P2_coarse"));

}  // namespace
}  // namespace palpate::elasticity
