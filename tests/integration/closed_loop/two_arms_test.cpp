// Two arms that hold the two ends of a bar, through the daemon.

#include <cmath>
#include <palpate/estimate_t.hpp>

#include "core/elasticity/worst_elements.hpp"
#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

constexpr double kTwoHandBarLength = 0.5;  // m, of the bar
const char* const kTwoHandScene = "sim/scenes/bar_two_hands.yaml";
const char* const kTwoHandControlScene = "sim/scenes/bar_two_hands_control.yaml";
const char* const kTwoArmsConfiguration = "rt/config/examples/bar_two_hands.yaml";

TEST(TwoArmsLoop, ConfigurationRepeatsTheScenesFrames) {
  ClosedLoop loop(kTwoHandScene, kTwoArmsConfiguration);
  loop.run(0.1);
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  ASSERT_EQ(pipeline.arm_count(), 2);
  for (int i = 0; i < 2; ++i) {
    const registry::Frames& frames = pipeline.frames(i);
    const math::Pose X_OG =
        frames.X_WO.inverse() * loop.daemon().inputs().signals(i).robot.latest.X_WE * frames.X_EG;
    const math::Pose truth = loop.simulation().arm(i).grasp_in_object();
    EXPECT_LT((X_OG.translation() - truth.translation()).norm(), 1e-3) << i;
    EXPECT_LT((X_OG.linear() - truth.linear()).norm(), 1e-3) << i;
    EXPECT_TRUE(pipeline.object().body.grasps[i].X_OG_rest.isApprox(truth, 1e-5)) << i;
  }
}

TEST(TwoArmsLoop, ShapeAndBothWrenchesFollowThePlant) {
  ClosedLoop loop(kTwoHandScene, kTwoArmsConfiguration);
  loop.run(0.1);
  loop.send_event("start");
  loop.run(8.0);  // into the S-bend
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  EXPECT_EQ(pipeline.condition().state, pipeline::LifeCycle::kActive)
      << pipeline.condition().reason;
  const Eigen::VectorXd error = loop.shape_error();
  std::printf("mean %.2f mm, max %.2f mm\n", 1e3 * error.mean(), 1e3 * error.maxCoeff());
  EXPECT_LT(error.mean(), 0.01 * kTwoHandBarLength);
  EXPECT_LT(error.maxCoeff(), 0.02 * kTwoHandBarLength);

  // Readings of the wrist sensors without their noise.
  Eigen::Vector3d felt[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  constexpr int kTicks = 500;
  loop.run(1e-3 * kTicks, [&] {
    const sensing::ContactSet& contacts = pipeline.contacts();
    ASSERT_EQ(contacts.count, 2) << "the wrist sensor of either arm";
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(static_cast<int>(contacts.contacts[i].source), i);
      felt[i] += contacts.contacts[i].wrench.force / kTicks;
    }
  });
  for (int i = 0; i < 2; ++i) {
    const math::Wrench truth = loop.simulation().plant().hand_wrench(i);
    const math::Wrench& predicted = pipeline.estimate().reaction[i];
    const double scale = truth.force.norm();
    std::printf("hand %d: %.3f N, predicted within %.3f N, felt within %.3f N\n", i, scale,
                (predicted.force - truth.force).norm(), (felt[i] - truth.force).norm());
    EXPECT_GT(scale, 0.3) << "N: it is bent";
    EXPECT_LT((predicted.force - truth.force).norm(), 0.2 * scale) << i;
    EXPECT_LT((felt[i] - truth.force).norm(), 0.1) << i;
  }
}

TEST(TwoArmsLoop, BothArmsBringAPointBetweenThemToItsTarget) {
  ClosedLoop loop(kTwoHandControlScene, kTwoArmsConfiguration);
  loop.run(0.1);
  loop.send_event("start");
  loop.run(0.5);
  const Eigen::Vector3d rest_point = loop.daemon().pipeline().feature().rest_points()[0];
  const object::HyperelasticPlant& plant = loop.simulation().plant();
  const Eigen::Vector3d target = plant.position_at(rest_point) + Eigen::Vector3d(0.01, 0.02, 0.03);
  const math::Pose before[2] = {loop.simulation().arm(0).grasp_in_object(),
                                loop.simulation().arm(1).grasp_in_object()};
  loop.send_target("point", target);
  loop.run(6.0);
  const double error = (plant.position_at(rest_point) - target).norm();
  std::printf("error %.2f mm\n", 1e3 * error);
  EXPECT_LT(error, 5e-3);
  Eigen::Vector3d way[2];
  for (int i = 0; i < 2; ++i) {
    const math::Pose now = loop.simulation().arm(i).grasp_in_object();
    way[i] = now.translation() - before[i].translation();
    EXPECT_GT(way[i].norm(), 0.01) << "both do their part";
  }
  // The point lies in the middle: both arms contribute equally.
  EXPECT_NEAR(way[0].norm() / way[1].norm(), 1, 0.25);
  EXPECT_TRUE(loop.daemon().pipeline().is_running());
}

// One side of the middle up, the other down, within limits of the hands, their wrenches and the
// object's load.
TEST(TwoArmsLoop, QuadraticProgramBendsTheBarIntoAnS) {
  constexpr double kForce = 1.2, kStretch = 1.03, kSpeed = 0.05;
  ClosedLoop loop(
      kTwoHandControlScene, kTwoArmsConfiguration, {},
      {"feature={component: points, rest_points: [[0.15, 0.03, 0.06], [0.25, 0.03, 0.06], [0.35, "
       "0.03, 0.06]]}",
       "control={provider: fem, law: quadratic_program, gain: 2, moves: both, linear_speed: 0.05, "
       "limits: {force: 1.2, stretch: 1.03}}"});
  loop.run(0.1);
  loop.send_event("start");
  loop.run(0.5);
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  const object::HyperelasticPlant& plant = loop.simulation().plant();
  const std::vector<Eigen::Vector3d>& points = pipeline.feature().rest_points();
  Eigen::VectorXd target(9);
  const double up[3] = {0.015, 0, -0.015};
  for (int i = 0; i < 3; ++i)
    target.segment<3>(3 * i) = plant.position_at(points[i]) + Eigen::Vector3d(0, 0, up[i]);
  loop.send_target("points", target);

  elasticity::WorstElements worst(pipeline.object().body, elasticity::Strain::kStretch);
  double force = 0, stretch = 0, speed = 0, acceleration = 0;
  math::Twist before[2];
  int tick = 0;
  loop.run(6.0, [&] {
    ++tick;
    for (int i = 0; i < 2; ++i) {
      const math::Twist& now = pipeline.gate_output(i).V_W_E;
      // At G, to which the limits refer, also when the flange rotates.
      const math::Pose& X_WE = loop.daemon().inputs().signals(i).robot.latest.X_WE;
      const math::Twist V_G = math::move_reference(
          now, Eigen::Vector3d(X_WE.linear() * pipeline.frames(i).X_EG.translation()));
      speed = std::max(speed, V_G.linear.norm());
      if (tick > 1)
        acceleration =
            std::max(acceleration, (now.linear - before[i].linear).cwiseAbs().maxCoeff() / 1e-3);
      before[i] = now;
      force = std::max(force, pipeline.estimate().reaction[i].force.cwiseAbs().maxCoeff());
    }
    worst.look(pipeline.model().positions());
    stretch = std::max(stretch, worst.peak());
  });
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    largest = std::max(largest, (plant.position_at(points[i]) - target.segment<3>(3 * i)).norm());
  std::printf(
      "error %.2f mm; force %.2f N, stretch %.3f, speed %.4f m/s, acceleration %.2f m/s^2\n",
      1e3 * largest, force, stretch, speed, acceleration);
  EXPECT_LT(largest, 3e-3);
  EXPECT_LE(force, 1.02 * kForce);
  EXPECT_LE(stretch - 1, 1.02 * (kStretch - 1));
  EXPECT_LE(speed, kSpeed * (1 + 1e-6));
  EXPECT_LE(acceleration, 0.5 * (1 + 1e-6)) << "the gate's, of the flange";
  EXPECT_TRUE(pipeline.is_running()) << pipeline.condition().reason;
}

// Joint limits are those of one arm.
TEST(TwoArmsLoop, JointsOfTheSecondArmAreRefused) {
  const auto error_of = [](const std::vector<std::string>& overrides) -> std::string {
    try {
      ClosedLoop loop(kTwoHandControlScene, kTwoArmsConfiguration, {}, overrides);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string urdf = "robot.urdf=" PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf";
  const std::vector<std::string> joints = {"control.law=quadratic_program",
                                           "control.command=joint_velocity"};
  EXPECT_NE(error_of({joints[0], joints[1], urdf}).find("moves the first arm only"),
            std::string::npos);
  EXPECT_NE(error_of({"second_arm." + urdf}).find("of the first arm only"), std::string::npos);
}

TEST(TwoArmsLoop, SecondArmFallingSilentStopsBoth) {
  ClosedLoop loop(kTwoHandControlScene, kTwoArmsConfiguration);
  loop.run(0.1);
  loop.send_event("start");
  loop.run(0.5);
  const Eigen::Vector3d rest_point = loop.daemon().pipeline().feature().rest_points()[0];
  loop.send_target("point", Eigen::Vector3d(rest_point + Eigen::Vector3d(0, 0, 0.05)));
  loop.run(0.5);
  daemon::Daemon& daemon = loop.daemon();
  for (int arm = 0; arm < 2; ++arm)
    EXPECT_GT(daemon.pipeline().gate_output(arm).V_W_E.linear.norm(), 0) << arm;

  loop.mute("_1");
  loop.run(0.4);
  EXPECT_EQ(daemon.pipeline().condition().state, pipeline::LifeCycle::kDegraded);
  for (int arm = 0; arm < 2; ++arm)
    EXPECT_EQ(daemon.pipeline().gate_output(arm).V_W_E.vector().norm(), 0) << arm;
  for (int i = 0; i < daemon.inputs().channel_count(); ++i) {
    const daemon::InputReport report = daemon.inputs().report(i);
    const std::string name = report.name;
    if (name == "ROBOT_STATE_1") {
      EXPECT_GT(report.age, 0.3);
    } else if (name == "ROBOT_STATE") {
      EXPECT_LT(report.age, 0.05);
    }
  }
}

TEST(TwoArmsLoop, TwoRunsAreBitIdentical) {
  Eigen::Matrix3Xd positions[2];
  for (Eigen::Matrix3Xd& x : positions) {
    ClosedLoop loop(kTwoHandScene, kTwoArmsConfiguration);
    loop.send_event("start");
    loop.run(1.5);
    x = loop.daemon().pipeline().model().positions();
  }
  EXPECT_TRUE((positions[0].array() == positions[1].array()).all());
}

}  // namespace
}  // namespace palpate
