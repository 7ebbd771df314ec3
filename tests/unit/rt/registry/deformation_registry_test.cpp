#include <gtest/gtest.h>

#include <string>

#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "tests/support/configured_model.hpp"

namespace palpate::registry {
namespace {

using support::configured_model;

TEST(DeformationRegistry, ModelsForComparisonAreMadeByName) {
  using elasticity::LinearModel;
  using elasticity::MassSpringModel;
  using elasticity::ShapeMatchingModel;
  EXPECT_NE(dynamic_cast<LinearModel*>(configured_model("{component: linear}").get()), nullptr);
  EXPECT_NE(dynamic_cast<MassSpringModel*>(configured_model("{component: mass_spring}").get()),
            nullptr);
  EXPECT_NE(
      dynamic_cast<ShapeMatchingModel*>(configured_model("{component: shape_matching}").get()),
      nullptr);
}

TEST(DeformationRegistry, TheirKeysReachThem) {
  const auto few = configured_model("{component: shape_matching, rings: 2, max_substeps: 1}");
  const auto many = configured_model("{component: shape_matching, rings: 2, max_substeps: 100}");
  EXPECT_EQ(dynamic_cast<elasticity::ShapeMatchingModel&>(*few).substeps(0.01), 1);
  EXPECT_GT(dynamic_cast<elasticity::ShapeMatchingModel&>(*many).substeps(0.01), 2);

  const auto model = configured_model("{component: mass_spring, iterations: 1, tolerance: 1e-12}");
  model->prepare();
  model->loads().setConstant(0.01);
  EXPECT_EQ(model->step(1e-3).iterations, 1);
}

TEST(DeformationRegistry, AStepBeyondItsBudgetKeepsItsShapeAndSaysSo) {
  const auto model =
      configured_model("{component: corotational_quasistatic, budget: 1e-9, accuracy: 0}");
  model->prepare();
  model->loads().setConstant(0.01);
  const elasticity::StepReport report = model->step(1e-3);
  EXPECT_EQ(report.status, elasticity::StepStatus::kNotConverged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(model->positions(), model->body().mesh.nodes);
}

TEST(DeformationRegistry, TheLawOfTheMaterialIsThatOfTheHyperelasticModelAlone) {
  const auto made = [](const std::string& deformation) {
    const config::Node root = config::Node::load_file(
        std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft_hyperelastic.yaml",
        {"deformation=" + deformation});
    Context context;
    context.frames = read_frames(root);
    const Object object = read_object(root, context.frames);
    context.object = &object;
    return make_deformation_model(root.child("deformation"), context);
  };
  const auto mooney = elasticity::find_stretch_law("mooney_rivlin")->make({0.2});
  EXPECT_EQ(made("{component: hyperelastic}")->body().law, mooney);
  EXPECT_NE(dynamic_cast<elasticity::CorotationalDynamic*>(
                made("{component: hyperelastic, inertia: true}").get()),
            nullptr);
  EXPECT_FALSE(made("{component: corotational_quasistatic}")->body().law.has_value());
  EXPECT_NE(support::configuration_error("{component: hyperelastic}").find("object.material.model"),
            std::string::npos);
}

/// Displacements after 200 steps of 1 ms under a load, the end in the hand, with these keys.
Eigen::Matrix3Xd swing(const std::string& keys) {
  const auto model = configured_model("{component: corotational_dynamic, " + keys + "}");
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

Eigen::Matrix3Xd swing(int threads) { return swing("threads: " + std::to_string(threads)); }

TEST(DeformationRegistry, TheShapeDoesNotDependOnWhoComputesTheFactor) {
  const Eigen::Matrix3Xd own = swing("factor: own");
  ASSERT_GT(own.cwiseAbs().maxCoeff(), 1e-4);
#ifdef PALPATE_SUITESPARSE
  const Eigen::Matrix3Xd cholmod = swing("factor: cholmod");
  EXPECT_LT((cholmod - own).cwiseAbs().maxCoeff(), 1e-5 * own.cwiseAbs().maxCoeff());
  EXPECT_EQ(cholmod, swing("confirm: true")) << "it is the default, and repeats to the bit";
#else
  EXPECT_NE(support::configuration_error("{component: corotational_dynamic, factor: cholmod}"), "");
  EXPECT_EQ(own, swing("confirm: true")) << "it is the default, and repeats to the bit";
#endif
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
        std::pair("{component: corotational_dynamic, factor: pardiso}", "factor"),
        std::pair("{component: linear, factor: own}", "factor"),
        std::pair("{component: mass_spring, cg_iterations: 0}", "cg_iterations"),
        std::pair("{component: shape_matching, rings: 6}", "rings"),
        std::pair("{component: shape_matching, max_substeps: 0}", "max_substeps")}) {
    const std::string error = support::configuration_error(deformation);
    EXPECT_NE(error.find(key), std::string::npos) << deformation << ": " << error;
  }
}

}  // namespace
}  // namespace palpate::registry
