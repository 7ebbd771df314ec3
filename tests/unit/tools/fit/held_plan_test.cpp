#include "tools/fit/held/held_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/unit/tools/fit/held_bar.hpp"
#include "tools/fit/held/held_plan_report.hpp"

namespace palpate::fit {
namespace {

control::GateLimits wide() {
  control::GateLimits limits;
  limits.workspace_lower.setConstant(-10);
  limits.workspace_upper.setConstant(10);
  limits.force = limits.torque = 1e3;
  return limits;
}

bool is_undetermined(const HeldPlan& plan, const std::string& name) {
  return std::count(plan.undetermined.begin(), plan.undetermined.end(), name) > 0;
}

const Knowledge& last(const HeldPlan& plan, const std::string& name) {
  const std::vector<Knowledge>& all = plan.steps.back().knowledge;
  return *std::find_if(all.begin(), all.end(),
                       [&](const Knowledge& known) { return known.name == name; });
}

/// The bar without weight: its displaced position does not depend on its stiffness.
HeldCell weightless() {
  HeldCell cell = make_held_bar();
  cell.object.body.gravity_O.setZero();
  return cell;
}

TEST(HeldPlan, PosesAloneDoNotDetermineTheModulusWithoutWeight) {
  HeldPlanOptions options;
  options.reads_wrench = false;
  options.markers = {{0.1, 0, 0.02}, {0.1, 0.05, 0.02}, {0.15, 0.025, 0.04}};
  options.marker_noise = 1e-5;
  const HeldPlan plan = plan_motions(weightless(), wide(), options);
  EXPECT_TRUE(is_undetermined(plan, "young_modulus"));
  EXPECT_TRUE(is_undetermined(plan, "density"));
  EXPECT_FALSE(is_undetermined(plan, "poisson_ratio"));
}

// Under its weight the shape identifies E over density: with the density known, E.
TEST(HeldPlan, SagDeterminesTheModulusWhereTheDensityIsKnown) {
  HeldPlanOptions options;
  options.reads_wrench = false;
  options.markers = {{0.1, 0, 0.02}, {0.1, 0.05, 0.02}, {0.15, 0.025, 0.04}};
  options.marker_noise = 1e-5;
  EXPECT_TRUE(is_undetermined(plan_motions(make_held_bar(), wide(), options), "young_modulus"));
  options.known = {"density"};
  EXPECT_FALSE(is_undetermined(plan_motions(make_held_bar(), wide(), options), "young_modulus"));
}

TEST(HeldPlan, WrenchDeterminesTheModulusAndRingingTheDamping) {
  const HeldPlan plan = plan_motions(weightless(), wide(), {});
  EXPECT_FALSE(is_undetermined(plan, "young_modulus"));
  EXPECT_FALSE(is_undetermined(plan, "stiffness_damping"));
  EXPECT_LT(last(plan, "young_modulus").factor(), 1.1);
  const bool stops = std::any_of(plan.steps.begin(), plan.steps.end(),
                                 [](const HeldPlanStep& s) { return !s.motion.stop.isZero(); });
  EXPECT_TRUE(stops);
  HeldPlanOptions unhurried;
  unhurried.speed = 0;
  EXPECT_TRUE(is_undetermined(plan_motions(weightless(), wide(), unhurried), "stiffness_damping"));
}

// With pulls and shifts forbidden by the gate's force limit, the modulus is not identifiable.
TEST(HeldPlan, LeavesOutWhatTheGateForbids) {
  control::GateLimits limits = wide();
  limits.force = limits.torque = 1e-6;
  HeldPlanOptions options;
  options.known = {"mass_damping", "stiffness_damping", "density"};
  options.speed = 0;
  const HeldPlan plan = plan_motions(weightless(), limits, options);
  EXPECT_GT(plan.left_out.size(), 25u);
  EXPECT_TRUE(is_undetermined(plan, "young_modulus"));
}

TEST(HeldPlan, EveryStepAddsInformation) {
  const HeldPlan plan = plan_motions(make_held_bar(), wide(), {});
  ASSERT_GE(plan.steps.size(), 2u);
  std::vector<Knowledge> before = plan.before;
  for (std::size_t s = 0; s < plan.steps.size(); ++s) {
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_LE(plan.steps[s].knowledge[k].deviation, before[k].deviation * (1 + 1e-9));
    before = plan.steps[s].knowledge;
  }
}

// A tool held by the hand alone: its weight identifies the density once it is tilted, regardless of
// the bias.
TEST(HeldPlan, TippingOverWeighsWhatOnlyTheHandHolds) {
  HeldCell cell = make_held_bar();
  cell.object.body.fixed_nodes.clear();
  HeldPlanOptions options;
  options.known = {"mass_damping", "stiffness_damping", "poisson_ratio", "young_modulus"};
  const HeldPlan plan = plan_motions(cell, wide(), options);
  EXPECT_FALSE(is_undetermined(plan, "density"));
  const math::Vector6d& tipped = plan.steps.back().motion.from_rest;
  EXPECT_GT(tipped.tail<3>().norm(), 1.5);
}

TEST(HeldPlan, IsPrintedAsAListAndAsJson) {
  HeldPlanOptions options;
  options.steps = 2;
  options.known = {"density"};
  const HeldPlan plan = plan_motions(make_held_bar(), wide(), options);
  std::ostringstream text;
  print(plan, text);
  EXPECT_NE(text.str().find("1. hold still"), std::string::npos);
  EXPECT_NE(text.str().find("2. " + plan.steps[1].motion.name), std::string::npos);
  EXPECT_EQ(text.str().find("density"), std::string::npos);
  const nlohmann::json json = to_json(plan);
  EXPECT_EQ(json["steps"].size(), 2u);
  const auto& young = json["steps"][1]["after"]["young_modulus"];
  EXPECT_NEAR(young["interval"][1].get<double>() / 3e4, last(plan, "young_modulus").factor(), 1e-9);
}

}  // namespace
}  // namespace palpate::fit
