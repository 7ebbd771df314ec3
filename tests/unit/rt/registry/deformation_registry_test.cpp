#include <gtest/gtest.h>

#include <string>

#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

/// Builds the model configured by `deformation`, on the example's bar.
std::unique_ptr<elasticity::DeformationModel> build(const std::string& deformation) {
  const config::Node root = config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml",
      {"deformation=" + deformation});
  Context context;
  context.frames = read_frames(root);
  const Object object = read_object(root, context.frames);
  context.object = &object;
  const config::Node node = root.child("deformation");
  auto model = make_deformation_model(node, context);
  node.check_all_used();
  return model;
}

std::string error_of(const std::string& deformation) {
  try {
    build(deformation);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(DeformationRegistry, ModelsForComparisonAreMadeByName) {
  using elasticity::LinearModel;
  using elasticity::MassSpringModel;
  using elasticity::ShapeMatchingModel;
  EXPECT_NE(dynamic_cast<LinearModel*>(build("{component: linear}").get()), nullptr);
  EXPECT_NE(dynamic_cast<MassSpringModel*>(build("{component: mass_spring}").get()), nullptr);
  EXPECT_NE(dynamic_cast<ShapeMatchingModel*>(build("{component: shape_matching}").get()), nullptr);
}

TEST(DeformationRegistry, TheirKeysReachThem) {
  const auto few = build("{component: shape_matching, rings: 2, max_substeps: 1}");
  const auto many = build("{component: shape_matching, rings: 2, max_substeps: 100}");
  EXPECT_EQ(dynamic_cast<elasticity::ShapeMatchingModel&>(*few).substeps(0.01), 1);
  EXPECT_GT(dynamic_cast<elasticity::ShapeMatchingModel&>(*many).substeps(0.01), 2);

  const auto model = build("{component: mass_spring, iterations: 1, tolerance: 1e-12}");
  model->prepare();
  model->loads().setConstant(0.01);
  EXPECT_EQ(model->step(1e-3).iterations, 1);
}

TEST(DeformationRegistry, AStepBeyondItsBudgetKeepsItsShapeAndSaysSo) {
  const auto model = build("{component: corotational_quasistatic, budget: 1e-9, accuracy: 0}");
  model->prepare();
  model->loads().setConstant(0.01);
  const elasticity::StepReport report = model->step(1e-3);
  EXPECT_EQ(report.status, elasticity::StepStatus::kNotConverged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(model->positions(), model->body().mesh.nodes);
}

/// End position after 200 steps of 1 ms under a load, the end in the hand, with this many threads.
Eigen::Matrix3Xd swing(int threads) {
  const auto model =
      build("{component: corotational_dynamic, threads: " + std::to_string(threads) + "}");
  model->prepare();
  model->hold(0, model->body().grasps[0].X_OG_rest);
  model->loads().row(2).setConstant(-1e-3);
  for (int k = 0; k < 200; ++k) {
    model->step(1e-3);
    elasticity::Refactorisation* job = k % 20 == 0 ? model->wanted_refactorisation() : nullptr;
    if (job == nullptr) continue;
    job->run();
    model->install(*job);
  }
  return model->positions() - model->body().mesh.nodes;
}

TEST(DeformationRegistry, ThreadsChangeNothingButTheLastBitsAndThoseNotTwice) {
  const Eigen::Matrix3Xd alone = swing(1);
  ASSERT_GT(alone.cwiseAbs().maxCoeff(), 1e-4);
  for (int threads : {2, 4}) {
    const Eigen::Matrix3Xd shared = swing(threads);
    EXPECT_LT((shared - alone).cwiseAbs().maxCoeff(), 1e-5 * alone.cwiseAbs().maxCoeff());
    for (int again = 0; again < 3; ++again) EXPECT_EQ(shared, swing(threads));
  }
}

TEST(DeformationRegistry, KeysOfOtherModelsAndValuesOutOfRangeAreNamed) {
  for (const auto& [deformation, key] :
       {std::pair("{component: linear, iterations: 2}", "iterations"),
        std::pair("{component: mass_spring, rings: 1}", "rings"),
        std::pair("{component: linear, threads: 2}", "threads"),
        std::pair("{component: corotational_dynamic, threads: 0}", "threads"),
        std::pair("{component: corotational_dynamic, threads: 9}", "threads"),
        std::pair("{component: corotational_dynamic, threads_fifo_priority: 99}",
                  "threads_fifo_priority"),
        std::pair("{component: shape_matching, tolerance: 1e-6}", "tolerance"),
        std::pair("{component: mass_spring, integrator: thesis2018}", "integrator"),
        std::pair("{component: linear, confirm: false}", "confirm"),
        std::pair("{component: corotational_dynamic, budget: -1}", "budget"),
        std::pair("{component: mass_spring, cg_iterations: 0}", "cg_iterations"),
        std::pair("{component: shape_matching, rings: 6}", "rings"),
        std::pair("{component: shape_matching, max_substeps: 0}", "max_substeps")}) {
    const std::string error = error_of(deformation);
    EXPECT_NE(error.find(key), std::string::npos) << deformation << ": " << error;
  }
}

}  // namespace
}  // namespace palpate::registry
