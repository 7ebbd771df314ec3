// What control does while the estimator reports that the wrenches contradict the model.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/doubtful_estimator.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::pipeline {
namespace {

constexpr const char* kContradiction = "the force of hand 0 along z contradicts the model";
constexpr const char* kTwistControl =
    "control={provider: fem, law: proportional_twist, gain: 1, linear_speed: 0.08";

/// A pipeline that moves the hand at constant speed towards a target that is far away.
class DiscrepancyPipeline : public ::testing::Test {
 protected:
  void build(const std::string& policy, const std::string& control = kTwistControl,
             const std::vector<std::string>& others = {}) {
    std::vector<std::string> all = {
        "sensing=[]",
        "object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}",
        "object.order=linear",
        "object.gravity=false",
        "object.grasp_box.lower=[0.495, 0, 0]",
        control + policy + "}"};
    all.insert(all.end(), others.begin(), others.end());
    const config::Node root =
        config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml", all);
    pipeline_ = std::make_unique<Pipeline>(root, 1e-3);
    std::unique_ptr<estimation::Estimator>& slot = pipeline_->components_at_setup().estimator;
    slot = std::make_unique<support::DoubtfulEstimator>(std::move(slot), doubt_);
    const sensing::RobotState joints = signals_.robot.latest;
    signals_ = support::at_rest(*pipeline_);
    signals_.robot.latest.joint_count = joints.joint_count;
    signals_.robot.latest.q = joints.q;
    start();
  }
  void start() {
    pipeline_->start();
    run(20);
    Eigen::VectorXd target = pipeline_->feature_state().value;
    target[2] += 0.5;
    const char* reason = "";
    ASSERT_TRUE(pipeline_->set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
    run(1000);
    ASSERT_EQ(pipeline_->condition().state, LifeCycle::kActive) << pipeline_->condition().reason;
    full_ = twist();
    ASSERT_GT(full_.linear.norm(), 0.02);
  }
  /// Every command is valid, and its changes keep the gate's limits: of the hand's acceleration, or
  /// of that of each joint where joints are commanded.
  void run(int cycles) {
    constexpr double kJointAcceleration = 5;  // rad/s^2, default of robot.joint_acceleration
    const control::GateLimits limits;
    for (int i = 0; i < cycles; ++i) {
      const control::GateOutput before = pipeline_->gate_output(0);
      support::run(*pipeline_, signals_, 1);
      const control::GateOutput& now = pipeline_->gate_output(0);
      EXPECT_FALSE(now.rejected) << now.reason;
      if (now.joint_velocity.size() > 0) {
        if (before.joint_velocity.size() == 0) continue;
        EXPECT_LE((now.joint_velocity - before.joint_velocity).cwiseAbs().maxCoeff(),
                  kJointAcceleration * 1e-3 * (1 + 1e-9));
        continue;
      }
      EXPECT_LE((now.V_W_E.linear - before.V_W_E.linear).norm(),
                limits.linear_acceleration * 1e-3 * (1 + 1e-9));
      EXPECT_LE((now.V_W_E.angular - before.V_W_E.angular).norm(),
                limits.angular_acceleration * 1e-3 * (1 + 1e-9));
    }
  }
  void report(bool is_inconsistent) { doubt_.report.is_inconsistent = is_inconsistent; }
  /// As PoseWrenchFilter does: by result and by report.
  void contradict(bool is_inconsistent) {
    report(is_inconsistent);
    doubt_.result =
        is_inconsistent ? UpdateResult{Status::kDoubtful, kContradiction} : UpdateResult{};
  }
  const math::Twist& twist() const { return pipeline_->gate_output(0).V_W_E; }
  void expect_share(double share) const {
    EXPECT_LT((twist().vector() - share * full_.vector()).norm(), 1e-12 + 1e-6 * share)
        << twist().vector().transpose() << ", full " << full_.vector().transpose();
  }
  void expect_degraded(const std::string& reason) const {
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kDegraded);
    EXPECT_EQ(pipeline_->condition().reason, reason);
  }

  support::Doubt doubt_;
  sensing::Signals signals_;
  std::unique_ptr<Pipeline> pipeline_;
  math::Twist full_;  // speed without a discrepancy
};

TEST_F(DiscrepancyPipeline, ControlSlowsByDefaultAndResumesByItself) {
  build("");
  contradict(true);
  run(500);
  expect_share(0.25);
  EXPECT_NE(std::string(pipeline_->gate_output(0).reason), "inactive");
  EXPECT_EQ(pipeline_->discrepancy_action(), control::DiscrepancyAction::kSlow);
  expect_degraded(std::string(kContradiction) + ": control slowed to 25 %");
  contradict(false);
  run(500);
  expect_share(1);
  EXPECT_EQ(pipeline_->condition().state, LifeCycle::kActive);
  EXPECT_EQ(pipeline_->discrepancy_action(), control::DiscrepancyAction::kContinue);
}

TEST_F(DiscrepancyPipeline, SpeedAndDirectionAreAsConfigured) {
  build(", discrepancy_speed: 0.1");
  contradict(true);
  run(500);
  expect_share(0.1);
  expect_degraded(std::string(kContradiction) + ": control slowed to 10 %");
}

// The gate would restore the speed of a command that is several times its limit.
TEST_F(DiscrepancyPipeline, ACommandBeyondTheGatesSpeedIsSlowedAsWell) {
  build("", "control={provider: fem, law: proportional_twist, gain: 50, linear_speed: 1");
  EXPECT_STREQ(pipeline_->gate_output(0).reason, "speed");
  contradict(true);
  run(500);
  expect_share(0.25);
  contradict(false);
  run(500);
  expect_share(1);
}

TEST_F(DiscrepancyPipeline, StopHoldsTheHandAndResumesByItself) {
  build(", on_discrepancy: stop");
  contradict(true);
  run(500);
  expect_share(0);
  EXPECT_NE(std::string(pipeline_->gate_output(0).reason), "inactive") << "the command is valid";
  expect_degraded(std::string(kContradiction) + ": control stopped");
  run(2000);
  expect_share(0);
  contradict(false);
  run(500);
  expect_share(1);
}

TEST_F(DiscrepancyPipeline, ResetEndsAStop) {
  build(", on_discrepancy: stop");
  contradict(true);
  run(500);
  pipeline_->reset();
  contradict(false);  // a reset clears the estimator's tests
  EXPECT_EQ(pipeline_->discrepancy_action(), control::DiscrepancyAction::kContinue);
  start();
  expect_share(1);
}

TEST_F(DiscrepancyPipeline, ContinueLeavesTheCommand) {
  build(", on_discrepancy: continue");
  contradict(true);
  for (int i = 0; i < 50; ++i) {
    run(10);
    expect_share(1);
  }
  expect_degraded(std::string(kContradiction) + ": control continues");
}

TEST_F(DiscrepancyPipeline, AReportAloneSuffices) {
  build("");
  report(true);
  run(500);
  expect_share(0.25);
  expect_degraded("the wrenches contradict the model: control slowed to 25 %");
}

TEST_F(DiscrepancyPipeline, WithoutAReportNothingChanges) {
  build(", on_discrepancy: stop");
  report(true);
  doubt_.has_report = false;
  run(500);
  expect_share(1);
  EXPECT_EQ(pipeline_->condition().state, LifeCycle::kActive);
}

// An estimate that is degraded for another reason never moves the robot, whatever the policy.
TEST_F(DiscrepancyPipeline, OtherReasonsStopAsBefore) {
  build(", on_discrepancy: continue");
  contradict(true);
  doubt_.result = {Status::kDegraded, "pose of the hand is stale"};
  for (int i = 0; i < 110; ++i) support::run(*pipeline_, signals_, 1);
  expect_share(0);
  EXPECT_STREQ(pipeline_->gate_output(0).reason, "inactive");
  expect_degraded("pose of the hand is stale");
  contradict(true);
  run(500);
  expect_share(1);
}

TEST_F(DiscrepancyPipeline, AnExplainedContactSlowsNothing) {
  build("");
  contradict(true);
  doubt_.has_contact = true;
  doubt_.report.threshold = 5;
  doubt_.report.test = 4;
  run(500);
  expect_share(1);
  expect_degraded(std::string(kContradiction) + ": an external contact explains it");
  doubt_.report.test = 6;  // beyond what the contact explains
  run(500);
  expect_share(0.25);
}

// The joints of sim/scenes/bar_long_soft_control.yaml, where the hand is at the grasp.
TEST_F(DiscrepancyPipeline, JointVelocitiesAreScaledAsWell) {
  const double q[] = {0.850909, -1.578487, -1.576241, 1.731603, 0.001266, 0.880669, 1.579363};
  signals_.robot.latest.joint_count = 7;
  signals_.robot.latest.q.head<7>() = Eigen::Map<const Eigen::Matrix<double, 7, 1>>(q);
  build(", on_discrepancy: stop",
        "control={provider: fem, law: quadratic_program, linear_speed: 0.03, command: "
        "joint_velocity",
        {"robot.urdf=" PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf"});
  EXPECT_GT(pipeline_->gate_output(0).joint_velocity.norm(), 0.01);
  contradict(true);
  run(500);
  EXPECT_EQ(pipeline_->gate_output(0).joint_velocity.norm(), 0);
  expect_share(0);
  contradict(false);
  run(500);
  // The law's joint velocities still drift by its null space.
  EXPECT_LT((twist().vector() - full_.vector()).norm(), 1e-3 * full_.vector().norm());
}

TEST(DiscrepancyConfiguration, WrongValuesAreNamedWithTheAllowedOnes) {
  const auto complaint = [](const std::string& override) -> std::string {
    try {
      const config::Node root = config::Node::load_file(
          PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml", {override});
      const Pipeline pipeline(root, 1e-3);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  for (const char* good : {"continue", "slow", "stop"})
    EXPECT_EQ(complaint(std::string("control.on_discrepancy=") + good), "");
  const std::string text = complaint("control.on_discrepancy=panic");
  for (const char* word : {"control.on_discrepancy", "panic", "continue", "slow", "stop"})
    EXPECT_NE(text.find(word), std::string::npos) << word << ": " << text;
  EXPECT_NE(complaint("control.discrepancy_speed=1.5").find("control.discrepancy_speed"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::pipeline
