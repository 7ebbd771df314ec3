#include "rt/pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/pipeline_cycles.hpp"

namespace palpate::pipeline {
namespace {

using support::at_rest;
using support::run;

const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

config::Node example(const std::vector<std::string>& overrides = {}) {
  return config::Node::load_file(kExample, overrides);
}

TEST(Pipeline, ExampleIsBuiltAndStartsInactive) {
  Pipeline pipeline(example(), 1e-3);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kInactive);
  EXPECT_FALSE(pipeline.is_running());
}

TEST(Pipeline, ShapeFollowsTheHand) {
  Pipeline pipeline(example({"object.gravity=false", "object.grasp_stiffness=~"}), 1e-3);
  sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 20);
  const Eigen::Matrix3Xd rest = pipeline.model().positions();
  signals.robot.latest.X_WE.translation().z() += 0.02;
  run(pipeline, signals, 200);
  for (int node : pipeline.object().body.grasps[0].nodes) {
    EXPECT_NEAR(pipeline.model().positions()(2, node) - rest(2, node), 0.02, 1e-8);
  }
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive);
}

TEST(Pipeline, StrainsBeyondThoseOfTheLawAreReportedWhileTheyLast) {
  Pipeline pipeline(example({"sensing=[]", "object.material.largest_strain=0.1"}), 1e-3);
  sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 50);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive);
  const double at_first = signals.robot.latest.X_WE.translation().z();
  for (const bool lifted : {true, false, true}) {
    signals.robot.latest.X_WE.translation().z() = at_first + (lifted ? 0.15 : 0);
    run(pipeline, signals, 500);
    const Condition condition = pipeline.condition();
    EXPECT_EQ(condition.state, lifted ? LifeCycle::kDegraded : LifeCycle::kActive);
    EXPECT_EQ(std::string(condition.reason).find("largest_strain") != std::string::npos, lifted);
  }
  Pipeline unchecked(example({"sensing=[]"}), 1e-3);
  unchecked.start();
  run(unchecked, signals, 500);
  EXPECT_EQ(unchecked.condition().state, LifeCycle::kActive);
}

/// Records its inputs, and does nothing.
class Witness : public estimation::Estimator {
 public:
  explicit Witness(estimation::ObservationInput& seen) : seen_(seen) {}
  void activate(elasticity::DeformationModel&) noexcept override {}
  UpdateResult update(const estimation::EstimationInputs& inputs, elasticity::DeformationModel&,
                      estimation::Estimate&) noexcept override {
    seen_ = inputs.observation;
    return {};
  }

 private:
  estimation::ObservationInput& seen_;
};

TEST(Pipeline, WhatIsSeenReachesTheEstimatorInTheObjectsFrame) {
  Pipeline pipeline(example(), 1e-3);
  estimation::ObservationInput seen;
  pipeline.components_at_setup().estimator = std::make_unique<Witness>(seen);
  sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 2);
  EXPECT_EQ(seen.freshness, Freshness::kNoData);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive) << "nothing need be seen";

  const Eigen::Vector3d p_O(0.25, 0.03, 0.06);
  signals.observation.freshness = Freshness::kNew;
  signals.observation.latest.count = 2;
  signals.observation.latest.deviation = 3e-4;
  signals.observation.latest.time = 7;
  signals.observation.latest.points_W.col(1) = (pipeline.frames().X_WO * p_O).cast<float>();
  run(pipeline, signals, 1);
  EXPECT_EQ(seen.freshness, Freshness::kNew);
  ASSERT_EQ(seen.points_O.cols(), 2);
  EXPECT_LT((seen.points_O.col(1) - p_O).norm(), 1e-6);
  EXPECT_EQ(seen.deviation, 3e-4);
  EXPECT_EQ(seen.time, 7);
}

TEST(Pipeline, NothingMovesBeforeStartOrWithoutTarget) {
  Pipeline pipeline(example(), 1e-3);
  const sensing::Signals signals = at_rest(pipeline);
  run(pipeline, signals, 50);
  EXPECT_EQ(pipeline.gate(1e-3).V_W_E.vector().norm(), 0);
  pipeline.start();
  run(pipeline, signals, 50);
  EXPECT_EQ(pipeline.gate(1e-3).V_W_E.vector().norm(), 0);
}

TEST(Pipeline, TargetMovesTheHandTowardsIt) {
  Pipeline pipeline(example({"sensing=[]"}), 1e-3);
  const sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 100);
  Eigen::VectorXd target = pipeline.feature_state().value;
  target[2] += 0.03;
  const char* reason = "";
  ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  run(pipeline, signals, 300);
  const Eigen::Vector3d v_O =
      pipeline.frames().X_WO.linear().transpose() * pipeline.gate(1e-3).V_W_E.linear;
  EXPECT_GT(v_O.z(), 0.005);
}

// A curvature without an axis has no direction of growth while the line is straight.
TEST(Pipeline, RestsAndSaysSoWhileTheShapeHasNoSuchFeature) {
  Pipeline pipeline(example({"sensing=[]", "object.gravity=false",
                             "feature={component: curvature, rest_points: [[0.05, 0.03, 0.03], "
                             "[0.1, 0.03, 0.0302], [0.15, 0.03, 0.03]]}"}),
                    1e-3);
  sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 100);
  const double target = 2;
  const char* reason = "";
  ASSERT_TRUE(pipeline.set_target(1, "curvature", nullptr, 0, &target, 1, reason)) << reason;
  int straight = 0;
  // Upwards, so that the bar's curvature first cancels that of the line and then exceeds it.
  for (int step = 0; step < 100; ++step) {
    signals.robot.latest.X_WE.translation().z() += 0.3e-3;
    run(pipeline, signals, 20);
    const bool rests = pipeline.gate(1e-3).V_W_E.vector().norm() == 0;
    if (pipeline.condition().state == LifeCycle::kDegraded) {
      EXPECT_STREQ(pipeline.condition().reason, "no such feature in this shape");
      ++straight;  // and the gate stops the hand at its own deceleration
      EXPECT_TRUE(straight < 6 || rests) << "step " << step;
    } else {
      EXPECT_TRUE(straight > 0 || step < 3 || !rests) << "step " << step;
    }
  }
  EXPECT_GT(straight, 6);
  EXPECT_LT(straight, 90);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive) << "recovers by itself";
}

TEST(Pipeline, TooMuchForceAtTheWristStopsTheHand) {
  Pipeline pipeline(example(), 1e-3);
  // The sensor reads zero instead of the hand's own weight: 47 N of apparent contact.
  const sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 100);
  Eigen::VectorXd target = pipeline.feature_state().value;
  target[2] += 0.03;
  const char* reason = "";
  ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  run(pipeline, signals, 300);
  const control::GateOutput output = pipeline.gate(1e-3);
  EXPECT_TRUE(output.rejected);
  EXPECT_EQ(output.V_W_E.vector().norm(), 0);
}

TEST(Pipeline, TargetsThatDoNotFitAreRefusedWithAReason) {
  Pipeline pipeline(example(), 1e-3);
  const double good[3] = {0.25, 0.03, 0.06};
  const double bad[3] = {0.25, std::nan(""), 0.06};
  const double other_point[1][3] = {{0.1, 0, 0}};
  const char* reason = "";
  EXPECT_FALSE(pipeline.set_target(1, "pose", nullptr, 0, good, 3, reason));
  EXPECT_STRNE(reason, "");
  EXPECT_FALSE(pipeline.set_target(1, "point", nullptr, 0, good, 2, reason));
  EXPECT_FALSE(pipeline.set_target(1, "point", nullptr, 0, bad, 3, reason));
  EXPECT_FALSE(pipeline.set_target(1, "point", other_point, 1, good, 3, reason));
  EXPECT_EQ(pipeline.target().revision, -1);
  EXPECT_TRUE(pipeline.set_target(1, "point", nullptr, 0, good, 3, reason));
}

/// Outputs a contact with one wrong number.
class WrongContact : public sensing::SensorModel {
 public:
  explicit WrongContact(double number) : number_(number) {}
  UpdateResult update(const sensing::Signals&, sensing::ContactSet& contacts) noexcept override {
    sensing::Contact contact;
    contact.source = sensing::Source::kWrist0;
    contact.wrench.torque.y() = number_;
    contacts.push(contact);
    return {};
  }

 private:
  double number_;
};

TEST(Pipeline, AContactThatCannotBeGoesNoFartherAndDegrades) {
  for (const double number : {0.5, std::nan(""), HUGE_VAL, 1e308}) {
    Pipeline pipeline(example(), 1e-3);
    pipeline.exchange_sensor_model(0, std::make_unique<WrongContact>(number));
    const sensing::Signals signals = at_rest(pipeline);
    pipeline.start();
    run(pipeline, signals, 200);
    const bool good = number == 0.5;
    EXPECT_EQ(pipeline.contacts().count, good ? 1 : 0) << number;
    EXPECT_EQ(pipeline.condition().state, good ? LifeCycle::kActive : LifeCycle::kDegraded)
        << number << pipeline.condition().reason;
  }
}

TEST(Pipeline, FaultIsLatchedUntilReset) {
  Pipeline pipeline(example(), 1e-3);
  const sensing::Signals signals = at_rest(pipeline);
  pipeline.start();
  run(pipeline, signals, 10);
  pipeline.fault("test");
  pipeline.start();
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kFaulted);
  run(pipeline, signals, 200);
  EXPECT_EQ(pipeline.gate(1e-3).V_W_E.vector().norm(), 0);
  pipeline.reset();
  pipeline.start();
  EXPECT_TRUE(pipeline.is_running());
}

/// The model in the slot fails from now on; a replacement does not.
void break_model(Pipeline& pipeline) {
  pipeline.model().set_gravity(Eigen::Vector3d::Constant(std::nan("")));
}

/// Cycles until the condition is `state`; -1 if it never is. Everything must stay finite, and the
/// pipeline must not be faulted in between.
int cycles_until(Pipeline& pipeline, const sensing::Signals& signals, LifeCycle state,
                 int taken_then) {
  for (int cycle = 1; cycle <= 3000; ++cycle) {
    run(pipeline, signals, 1);
    EXPECT_TRUE(pipeline.gate_output(0).V_W_E.vector().allFinite());
    if (pipeline.fallbacks_taken() == taken_then && pipeline.condition().state == state)
      return cycle;
    if (pipeline.condition().state == LifeCycle::kFaulted) return -1;
  }
  return -1;
}

TEST(Pipeline, WhereMechanicsFaultTheirFallbackGoesOnInTheSameTick) {
  Pipeline without(example({"sensing=[]"}), 1e-3);
  const sensing::Signals signals = at_rest(without);
  without.start();
  run(without, signals, 20);
  break_model(without);
  ASSERT_GT(cycles_until(without, signals, LifeCycle::kFaulted, 0), 0)
      << without.condition().reason;

  Pipeline pipeline(
      example({"sensing=[]", "deformation.fallback={component: corotational_dynamic}"}), 1e-3);
  pipeline.start();
  run(pipeline, signals, 20);
  break_model(pipeline);
  ASSERT_GT(cycles_until(pipeline, signals, LifeCycle::kDegraded, 1), 0)
      << pipeline.condition().reason;
  EXPECT_TRUE(pipeline.on_fallback());
  EXPECT_TRUE(pipeline.model().positions().allFinite());
  EXPECT_STREQ(pipeline.condition().reason, pipeline.fallback_reason());
  EXPECT_EQ(std::string(pipeline.condition().reason).rfind("estimation: fallback, since ", 0), 0u);

  // It controls as well.
  Eigen::VectorXd target = pipeline.feature_state().value;
  target[2] += 0.03;
  const char* reason = "";
  ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  run(pipeline, signals, 300);
  EXPECT_GT(pipeline.gate_output(0).V_W_E.linear.norm(), 0.005);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kDegraded) << "until reset";

  pipeline.reset();
  EXPECT_FALSE(pipeline.on_fallback());
  pipeline.start();
  run(pipeline, signals, 20);
  break_model(pipeline);
  EXPECT_GT(cycles_until(pipeline, signals, LifeCycle::kDegraded, 2), 0)
      << pipeline.fallbacks_taken() << " " << pipeline.condition().reason;
}

TEST(Pipeline, WhereTheControllerFaultsItsFallbackSteersInTheSameTick) {
  for (const bool fallback : {false, true}) {
    Pipeline pipeline(
        example(
            {"sensing=[]",
             std::string("control={provider: fem, law: proportional_twist, gain: 50") +
                 (fallback ? ", fallback: {provider: fem, law: proportional_twist, gain: 0.001}}"
                           : "}")}),
        1e-3);
    const sensing::Signals signals = at_rest(pipeline);
    pipeline.start();
    run(pipeline, signals, 100);
    const double target[3] = {1e308, 1e308, 1e308};
    const char* reason = "";
    ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target, 3, reason)) << reason;
    const LifeCycle expected = fallback ? LifeCycle::kDegraded : LifeCycle::kFaulted;
    EXPECT_EQ(cycles_until(pipeline, signals, expected, fallback ? 1 : 0), 1);
    EXPECT_EQ(pipeline.on_fallback(), fallback);
    EXPECT_EQ(std::string(pipeline.condition().reason),
              fallback ? "control: fallback, since the command is not finite"
                       : "the command is not finite");
    pipeline.reset();
    pipeline.start();
    run(pipeline, signals, 10);
    EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive);
  }
}

}  // namespace
}  // namespace palpate::pipeline
