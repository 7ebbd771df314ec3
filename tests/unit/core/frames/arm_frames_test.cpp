#include "core/frames/arm_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::frames {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using sensing::Source;

math::Pose pose(const Vector3d& p, const Vector3d& rotation) {
  return math::make_pose(math::exp_rotation(rotation), p);
}

/// Frames without any special position or axis.
ArmFrames oblique() {
  ArmFrames frames;
  frames.X_WO = pose({0.4, -0.1, 0.2}, {0.3, -0.5, 1.1});
  frames.X_ES = pose({0.01, 0.02, 0.05}, {0, 0.2, 0.7});
  frames.X_EG = pose({-0.02, 0.03, 0.2}, {0.4, 0, -0.2});
  return frames;
}

const math::Pose kX_WE = pose({0.5, 0.3, 0.6}, {-0.8, 0.4, 0.2});

TEST(ArmFrames, PosesInTheObjectComposeThroughTheBase) {
  const ArmFrames frames = oblique();
  const Vector3d p_G(0.1, 0.2, 0.3);
  const Vector3d p_W = kX_WE * (frames.X_EG * p_G);
  EXPECT_TRUE((frames.X_WO * (frames.X_OG(kX_WE) * p_G)).isApprox(p_W, 1e-12));
  EXPECT_TRUE(frames.X_OG(kX_WE).isApprox(frames.X_OE(kX_WE) * frames.X_EG, 1e-12));
}

TEST(ArmFrames, AWrenchKeepsItsForceAndItsMomentAboutEveryPoint) {
  const ArmFrames frames = oblique();
  const math::Wrench F_S{{1, -2, 3}, {0.1, 0.4, -0.2}};
  const math::Pose X_OG = frames.X_OG(kX_WE);
  const math::Wrench F_O = frames.wrench_in_object(F_S, X_OG.linear());
  const math::Pose X_OS = frames.X_OE(kX_WE) * frames.X_ES;
  EXPECT_TRUE(F_O.force.isApprox(X_OS.linear() * F_S.force, 1e-12));
  // about the origin of O
  const Vector3d by_sensor =
      X_OS.linear() * F_S.torque + X_OS.translation().cross(X_OS.linear() * F_S.force);
  const Vector3d by_grasp = F_O.torque + X_OG.translation().cross(F_O.force);
  EXPECT_TRUE(by_grasp.isApprox(by_sensor, 1e-12));
}

TEST(ArmFrames, DeviationOfATransformedWrenchIsThatOfItsComponents) {
  const math::Pose X_AB = pose({0.1, -0.3, 0.2}, {0.7, 0.2, -0.5});
  constexpr double kForce = 0.3, kTorque = 0.02;
  math::Vector6d variance = math::Vector6d::Zero();  // sum over independent errors at B
  for (int i = 0; i < 6; ++i) {
    const math::Vector6d error = (i < 3 ? kForce : kTorque) * math::Vector6d::Unit(i);
    variance += math::transform(X_AB, math::Wrench::from(error)).vector().cwiseAbs2();
  }
  EXPECT_LT((transformed_deviation(X_AB, kForce, kTorque) - variance.cwiseSqrt()).norm(), 1e-14);
}

TEST(ArmFrames, CovarianceOfATransformedWrenchIsThatOfItsErrors) {
  const math::Pose X_AB = pose({0.1, -0.3, 0.2}, {0.7, 0.2, -0.5});
  math::Matrix6d errors, covariance = math::Matrix6d::Zero();  // columns: independent errors at B
  for (int i = 0; i < 36; ++i) errors(i) = std::sin(3.7 * i);
  for (int i = 0; i < 6; ++i) {
    const math::Vector6d error = math::transform(X_AB, math::Wrench::from(errors.col(i))).vector();
    covariance += error * error.transpose();
  }
  EXPECT_LT((transformed_covariance(X_AB, errors * errors.transpose()) - covariance).norm(), 1e-12);
}

TEST(ArmFrames, ATwistIsThatOfTheMovingGrasp) {
  const ArmFrames frames = oblique();
  const math::Twist V_W_E{{0.1, -0.2, 0.05}, {0.3, 0.1, -0.4}};
  const math::Twist V_O_G = frames.grasp_twist(V_W_E, kX_WE.linear());
  constexpr double kDt = 1e-6;
  math::Pose later = kX_WE;
  later.translation() += kDt * V_W_E.linear;
  later.linear() = math::exp_rotation(kDt * V_W_E.angular) * kX_WE.linear();
  const math::Pose X_OG = frames.X_OG(kX_WE), X_OG_later = frames.X_OG(later);
  const Vector3d linear = (X_OG_later.translation() - X_OG.translation()) / kDt;
  const Vector3d angular =
      math::log_rotation(X_OG_later.linear() * X_OG.linear().transpose()) / kDt;
  EXPECT_TRUE(V_O_G.linear.isApprox(linear, 1e-5));
  EXPECT_TRUE(V_O_G.angular.isApprox(angular, 1e-5));
}

TEST(ArmFrames, TwistsOfFlangeAndGraspAreInverse) {
  const ArmFrames frames = oblique();
  const math::Twist V_O_G{{0.1, -0.2, 0.05}, {0.3, 0.1, -0.4}};
  const math::Twist back =
      frames.grasp_twist(frames.flange_twist(V_O_G, kX_WE.linear()), kX_WE.linear());
  EXPECT_TRUE(back.vector().isApprox(V_O_G.vector(), 1e-12));
}

TEST(ArmFrames, NearPosesDifferInNeitherPlaceNorAngle) {
  EXPECT_TRUE(are_near(kX_WE, kX_WE, 1e-6, 1e-6));
  math::Pose moved = kX_WE;
  moved.translation().y() += 0.01;
  EXPECT_TRUE(are_near(kX_WE, moved, 0.011, 1e-6));
  EXPECT_FALSE(are_near(kX_WE, moved, 0.009, 1e-6));
  math::Pose turned = kX_WE;
  turned.linear() *= math::exp_rotation({0, 0.1, 0});
  EXPECT_TRUE(are_near(kX_WE, turned, 1e-6, 0.101));
  EXPECT_FALSE(are_near(kX_WE, turned, 1e-6, 0.099));
  turned.linear() = kX_WE.linear() * math::exp_rotation({0, math::kPi, 0});
  EXPECT_FALSE(are_near(kX_WE, turned, 1e-6, 1));
}

class MeasurementsTest : public ::testing::Test {
 protected:
  MeasurementsTest() {
    frames_.X_WO = math::make_pose(math::exp_rotation({0, 0, 1.2}), {0.4, 0, 0.1});
    frames_.X_ES = math::make_pose(math::exp_rotation({0.5, 0, 0}), {0, 0, 0.05});
    frames_.X_EG = math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.2});
    second_frames_ = frames_;
    second_frames_.X_WO.translation().x() = -0.4;
    signals_.robot.freshness = Freshness::kNew;
    signals_.robot.latest.X_WE = math::make_pose(math::exp_rotation({0, 0.3, 0}), {0.5, 0.2, 0.4});
  }
  static sensing::Contact contact(Source source) {
    sensing::Contact contact;
    contact.source = source;
    contact.location = {0.001, 0.002, 0.003};
    contact.wrench = {{1, 2, 3}, {0.1, 0.2, 0.3}};
    return contact;
  }
  sensing::ContactSet located(const sensing::Contact& contact, bool known = true) {
    sensing::ContactSet contacts, contacts_O;
    contacts.push(contact);
    contacts_O.count = 5;  // from the tick before
    to_object_frame(contacts, {frames_, signals_, known}, {second_frames_, signals_, known},
                    contacts_O);
    return contacts_O;
  }
  math::Pose X_OG() const { return frames_.X_OG(signals_.robot.latest.X_WE); }

  ArmFrames frames_, second_frames_;
  sensing::Signals signals_;
};

TEST_F(MeasurementsTest, TheWristsWrenchActsAtTheGrasp) {
  const sensing::ContactSet contacts = located(contact(Source::kWrist0));
  ASSERT_EQ(contacts.count, 1);
  const sensing::Contact& wrist = contacts.contacts[0];
  EXPECT_EQ(wrist.location, X_OG().translation());
  const math::Wrench expected =
      frames_.wrench_in_object(contact(Source::kWrist0).wrench, X_OG().linear());
  EXPECT_EQ(wrist.wrench.force, expected.force);
  EXPECT_EQ(wrist.wrench.torque, expected.torque);
}

TEST_F(MeasurementsTest, TheSecondWristHasItsOwnFrames) {
  const sensing::ContactSet contacts = located(contact(Source::kWrist1));
  ASSERT_EQ(contacts.count, 1);
  EXPECT_EQ(contacts.contacts[0].location,
            second_frames_.X_OG(signals_.robot.latest.X_WE).translation());
}

TEST_F(MeasurementsTest, AWristOfAnUnknownArmIsLeftOut) {
  EXPECT_EQ(located(contact(Source::kWrist0), false).count, 0);
  EXPECT_EQ(located(contact(Source::kWrist1), false).count, 0);
}

TEST_F(MeasurementsTest, AFingertipIsWhereTheHandReportsIt) {
  EXPECT_EQ(located(contact(Source::kFinger1)).count, 0);  // no state of the hand yet
  signals_.hand.freshness = Freshness::kOld;
  signals_.hand.latest.fingertip_count = 2;
  signals_.hand.latest.X_ET[1] = math::make_pose(math::exp_rotation({0, 0, 0.4}), {0.01, 0, 0.1});
  EXPECT_EQ(located(contact(Source::kFinger1), false).count, 0);
  EXPECT_EQ(located(contact(Source::kFinger2)).count, 0);  // the hand has two
  const sensing::ContactSet contacts = located(contact(Source::kFinger1));
  ASSERT_EQ(contacts.count, 1);
  const math::Pose X_OT = frames_.X_OE(signals_.robot.latest.X_WE) * signals_.hand.latest.X_ET[1];
  EXPECT_TRUE(contacts.contacts[0].location.isApprox(X_OT * Vector3d(0.001, 0.002, 0.003)));
  EXPECT_TRUE(contacts.contacts[0].wrench.force.isApprox(X_OT.linear() * Vector3d(1, 2, 3)));
  EXPECT_TRUE(contacts.contacts[0].wrench.torque.isApprox(X_OT.linear() * Vector3d(0.1, 0.2, 0.3)));
}

TEST_F(MeasurementsTest, AFixedFingertipNeedsNoArm) {
  frames_.X_OT[3] = math::make_pose(Eigen::Matrix3d::Identity(), {0.1, 0.2, 0.3});
  const sensing::ContactSet contacts = located(contact(Source::kFinger3), false);
  ASSERT_EQ(contacts.count, 1);
  EXPECT_TRUE(contacts.contacts[0].location.isApprox(Vector3d(0.101, 0.202, 0.303)));
}

TEST_F(MeasurementsTest, AManualContactIsUnchanged) {
  const sensing::ContactSet contacts = located(contact(Source::kManual), false);
  ASSERT_EQ(contacts.count, 1);
  EXPECT_EQ(contacts.contacts[0].location, Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(contacts.contacts[0].wrench.force, Vector3d(1, 2, 3));
}

estimation::GraspInput grasp_input(const ArmMeasurements& arm,
                                   const sensing::ContactSet& contacts_O) {
  estimation::GraspInput input;
  input.wrench_valid = true;  // of the previous tick
  update_grasp(arm, 0, contacts_O, input);
  return input;
}

TEST_F(MeasurementsTest, AGraspHasThePoseAndTheWrenchOfItsOwnHand) {
  sensing::ContactSet contacts_O = located(contact(Source::kWrist1));
  const ArmMeasurements arm{frames_, signals_, true};
  estimation::GraspInput input = grasp_input(arm, contacts_O);
  EXPECT_TRUE(input.holding);
  EXPECT_EQ(input.pose_freshness, Freshness::kNew);
  EXPECT_TRUE(input.X_OG.isApprox(X_OG()));
  EXPECT_FALSE(input.wrench_valid);
  contacts_O = located(contact(Source::kWrist0));
  input = grasp_input(arm, contacts_O);
  EXPECT_TRUE(input.wrench_valid);
  EXPECT_EQ(input.F_G_O.force, contacts_O.contacts[0].wrench.force);
}

TEST_F(MeasurementsTest, AHandThatReportsItsGraspDecidesWhetherItHolds) {
  const ArmMeasurements arm{frames_, signals_, true};
  signals_.hand.freshness = Freshness::kOld;
  signals_.hand.latest.grasp = sensing::Grasp::kNone;
  EXPECT_FALSE(grasp_input(arm, {}).holding);
  signals_.hand.latest.grasp = sensing::Grasp::kHolding;
  EXPECT_TRUE(grasp_input(arm, {}).holding);
  EXPECT_FALSE(grasp_input({frames_, signals_, false}, {}).holding);
}

TEST_F(MeasurementsTest, ObservedPointsAreConvertedOnce) {
  auto& stream = signals_.observation;
  stream.freshness = Freshness::kNew;
  stream.age = 0.01;
  stream.latest.count = 2;
  stream.latest.deviation = 1e-3;
  stream.latest.points_W.col(1) = Eigen::Vector3f(0.5F, 0.25F, 0.125F);
  estimation::ObservationInput observation;
  update_observation({frames_, signals_, true}, observation);
  ASSERT_EQ(observation.points_O.cols(), 2);
  EXPECT_TRUE(
      (frames_.X_WO * Vector3d(observation.points_O.col(1))).isApprox(Vector3d(0.5, 0.25, 0.125)));
  EXPECT_EQ(observation.deviation, 1e-3);
  stream.freshness = Freshness::kOld;
  stream.age = 0.02;
  stream.latest.count = 1;
  update_observation({frames_, signals_, true}, observation);
  EXPECT_EQ(observation.freshness, Freshness::kOld);
  EXPECT_EQ(observation.age, 0.02);
  EXPECT_EQ(observation.points_O.cols(), 2);
}

}  // namespace
}  // namespace palpate::frames
