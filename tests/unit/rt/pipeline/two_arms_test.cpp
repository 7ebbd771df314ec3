// The pipeline with a second arm: its keys, its gate, and which faults stop which arm.

#include <gtest/gtest.h>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::pipeline {
namespace {

const std::string kTwoHands =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_two_hands.yaml";
const std::string kOneHand =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

std::string error_of(const std::string& file, const std::vector<std::string>& overrides) {
  try {
    const config::Node root = config::Node::load_file(file, overrides);
    const Pipeline pipeline(root, 1e-3);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

class TwoArms : public ::testing::Test {
 protected:
  void build(const std::vector<std::string>& overrides) {
    pipeline_ = std::make_unique<Pipeline>(config::Node::load_file(kTwoHands, overrides), 1e-3);
    for (int i = 0; i < 2; ++i) signals_[i] = support::at_rest(*pipeline_, i);
    pipeline_->start();
  }

  void run(int cycles) { support::run(*pipeline_, signals_[0], signals_[1], cycles); }

  void aim(const Eigen::Vector3d& way) {
    const Eigen::VectorXd target = pipeline_->feature_state().value + way;
    const char* reason = "";
    ASSERT_TRUE(pipeline_->set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  }

  /// Velocity of the flange of `arm`, in O.
  Eigen::Vector3d velocity(int arm) const {
    return pipeline_->frames(arm).X_WO.linear().transpose() *
           pipeline_->gate_output(arm).V_W_E.linear;
  }

  /// The wrist of `arm` reports this, without processing.
  void push(int arm, const Eigen::Vector3d& force) {
    sensing::Stream<sensing::ForceTorque>& stream = signals_[arm].force_torque;
    stream.freshness = Freshness::kNew;
    stream.age = 0;
    stream.fresh_count = 1;
    stream.latest.F_S.force = force;
    stream.fresh[0] = stream.latest;
  }

  static constexpr const char* kPlainWrists =
      "sensing=[{component: ft_tare_only, tare_at_start: false, tare_samples: 1}, "
      "{component: ft_tare_only, tare_at_start: false, tare_samples: 1, arm: 1}]";

  std::unique_ptr<Pipeline> pipeline_;
  std::array<sensing::Signals, 2> signals_;
};

TEST_F(TwoArms, BothMoveThePointBetweenThem) {
  build({"sensing=[]"});
  run(100);
  aim({0, 0, 0.03});
  run(300);
  EXPECT_GT(velocity(0).z(), 0.005);
  EXPECT_NEAR(velocity(1).z() / velocity(0).z(), 1, 0.2);
  // Along the bar both move in the same direction, regardless of the orientation of their bases.
  aim({0.02, 0, 0});
  run(600);
  EXPECT_GT(velocity(0).x(), 0.002);
  EXPECT_GT(velocity(1).x(), 0.002);
}

TEST_F(TwoArms, OneMovesAndTheOtherHolds) {
  for (const int mover : {0, 1}) {
    build({"sensing=[]", std::string("control.moves=") + (mover == 0 ? "first" : "second")});
    run(100);
    aim({0, 0, 0.03});
    run(300);
    EXPECT_GT(velocity(mover).z(), 0.005) << mover;
    EXPECT_EQ(pipeline_->gate_output(1 - mover).V_W_E.vector().norm(), 0) << mover;
  }
}

TEST_F(TwoArms, ALostArmStopsBothAndDegrades) {
  for (const int lost : {0, 1}) {
    build({"sensing=[]"});
    run(100);
    aim({0, 0, 0.03});
    run(200);
    ASSERT_GT(velocity(0).norm(), 0);
    signals_[lost].robot.freshness = Freshness::kOld;
    run(400);
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kDegraded) << lost;
    for (int arm = 0; arm < 2; ++arm) EXPECT_EQ(velocity(arm).norm(), 0) << lost << arm;
    signals_[lost].robot.freshness = Freshness::kNew;
    run(100);
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kActive) << lost;
    EXPECT_GT(velocity(lost).norm(), 0) << lost;
  }
}

TEST_F(TwoArms, TooMuchForceAtEitherWristStopsBoth) {
  for (const int pressed : {0, 1}) {
    build({kPlainWrists});
    for (int arm = 0; arm < 2; ++arm) push(arm, Eigen::Vector3d::Zero());
    run(100);
    aim({0, 0, 0.03});
    run(200);
    ASSERT_GT(velocity(0).norm(), 0);
    ASSERT_GT(velocity(1).norm(), 0);
    push(pressed, {0, 0, 30});  // N, above the limit of 20
    run(200);
    EXPECT_TRUE(pipeline_->gate_output(pressed).rejected) << pressed;
    for (int arm = 0; arm < 2; ++arm) EXPECT_EQ(velocity(arm).norm(), 0) << pressed << arm;
    push(pressed, Eigen::Vector3d::Zero());
    run(100);
    for (int arm = 0; arm < 2; ++arm) EXPECT_GT(velocity(arm).norm(), 0) << pressed << arm;
  }
}

TEST_F(TwoArms, ContactsNameTheWristThatFeltThem) {
  build({kPlainWrists});
  push(0, {0, 0, 1});
  push(1, {0, 0, 2});
  run(5);
  const sensing::ContactSet& contacts = pipeline_->contacts();
  ASSERT_EQ(contacts.count, 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(static_cast<int>(contacts.contacts[i].source), i);
    EXPECT_NEAR(contacts.contacts[i].wrench.force.norm(), i + 1, 1e-9);
    EXPECT_LT(
        (contacts.contacts[i].location - pipeline_->object().body.grasps[i].X_OG_rest.translation())
            .norm(),
        1e-6);
  }
}

TEST(TwoArmsConfiguration, WrongKeysAreNamed) {
  const auto expect = [](const std::string& file, const std::string& setting,
                         const std::string& word) {
    const std::string error = error_of(file, {setting});
    EXPECT_NE(error.find(word), std::string::npos) << setting << ": " << error;
  };
  expect(kOneHand, "control.moves=both", "second_arm");
  expect(kOneHand, "sensing.0.arm=1", "second_arm");
  expect(kOneHand, "object.second_grasp_box={lower: [0.2, 0, 0], upper: [0.3, 1, 1]}",
         "second_arm");
  expect(kOneHand, "contact.0.grasp=1", "second_grasp_box");
  expect(kTwoHands, "control.provider=kinematic", "provider");
  expect(kTwoHands, "second_arm.frames.fingertips_in_object=[]", "fingertips");
  expect(kTwoHands, "object.second_grasp_box={lower: [0.44, 0, 0], upper: [0.5, 1, 1]}",
         "held twice");
  expect(kTwoHands, "second_arm.gate.linear_speed=-1", "linear_speed");
}

}  // namespace
}  // namespace palpate::pipeline
