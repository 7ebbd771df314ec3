#include "sim/sensors/sensor_suite.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::sensors {
namespace {

SensorTable table(const std::string& scene = "{}") {
  const config::Node node = config::Node::from_text(scene);
  const SensorTable read = read_sensors(node);
  node.check_all_used();
  return read;
}

math::Pose some_pose() {
  return math::make_pose(math::exp_rotation({0.4, -0.9, 1.2}), {0.3, -0.2, 0.8});
}

math::Pose grasp() {
  return math::make_pose(math::exp_rotation({0, 1.5, 0.2}), {0.01, -0.02, 0.3});
}

Truth some_truth() {
  Truth truth;
  truth.force_torque.wrench << 1, -2, 47, 0.1, -0.3, 0.02;
  truth.imu.motion << 0.1, 9.7, -0.4, 0.3, 0.2, 0.1;
  truth.robot.q = Eigen::VectorXd::LinSpaced(7, -1, 1);
  truth.robot.dq = Eigen::VectorXd::LinSpaced(7, 0.5, -0.3);
  truth.robot.tau = Eigen::VectorXd::LinSpaced(7, 40, 1);
  truth.robot.X_WE = some_pose();
  truth.jacobian = Eigen::Matrix<double, 6, 7>::Identity();
  truth.jacobian.col(6).setConstant(0.3);
  truth.robot.V_W_E = math::Twist::from(truth.jacobian * truth.robot.dq);
  truth.hand.holding = true;
  truth.hand.X_ET = {grasp(), grasp()};
  return truth;
}

const std::string kClean =
    "{force_torque: {force: {step: 0, noise: 0}, torque: {step: 0, noise: 0}},"
    " imu: {acceleration: {step: 0, noise: 0}, angular_velocity: {step: 0, noise: 0}},"
    " robot_state: {position: {step: 0, noise: 0}, velocity: {noise: 0}, torque: {noise: 0}},"
    " hand_state: {fingertip: {noise: 0}}";

TEST(SensorTable, IsTheNormativeOne) {
  const SensorTable t = table();
  EXPECT_EQ(t.force_torque.timing.rate, 1000);
  EXPECT_EQ(t.imu.timing.rate, 300);
  EXPECT_EQ(t.robot_state.timing.rate, 500);
  EXPECT_EQ(t.hand_state.timing.rate, 100);
  EXPECT_EQ(t.force_torque.force.step, 0.0125);
  EXPECT_EQ(t.force_torque.force.noise, 2 * t.force_torque.force.step);
  EXPECT_EQ(t.force_torque.torque.step, 0.0005);
  EXPECT_EQ(t.force_torque.torque.noise, 2 * t.force_torque.torque.step);
  EXPECT_TRUE(t.kinematics_error.isApprox(math::Pose::Identity()));
}

TEST(SensorTable, ASceneOverridesSingleEntries) {
  const SensorTable t = table("{force_torque: {bias: [1, 2, 3, 4, 5, 6]}, imu: {rate: 100}}");
  EXPECT_EQ(t.force_torque.bias, (math::Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(t.force_torque.force.noise, table().force_torque.force.noise);
  EXPECT_EQ(t.imu.timing.rate, 100);
  EXPECT_EQ(t.imu.timing.delay, table().imu.timing.delay);
  EXPECT_THROW(table("{imu: {rate: -1}}"), config::Error);
  EXPECT_THROW(table("{imu: {range: 1}}"), config::Error);
}

TEST(SensorSuite, PublishesAtTheRatesOfTheTable) {
  SensorSuite suite(table(), 1, grasp(), 7);
  const Truth truth = some_truth();
  int ft = 0, imu = 0, robot = 0, hand = 0;
  for (std::int64_t now = 1000; now <= 5'000'000; now += 1000) {
    suite.sample(now, truth);
    ForceTorqueReading a;
    while (suite.take(now, a)) ++ft;
    InertialReading b;
    while (suite.take(now, b)) ++imu;
    RobotReading c;
    while (suite.take(now, c)) ++robot;
    HandReading d;
    while (suite.take(now, d)) ++hand;
  }
  EXPECT_NEAR(ft, 5000, 2);
  EXPECT_NEAR(imu, 1500, 3);
  EXPECT_NEAR(robot, 2500, 2);
  EXPECT_NEAR(hand, 500, 2);
}

TEST(SensorSuite, WithoutFaultsReportsTheTruth) {
  SensorSuite suite(table(kClean + "}"), 1, grasp(), 7);
  const Truth truth = some_truth();
  suite.sample(0, truth);
  RobotReading robot;
  ASSERT_TRUE(suite.take(10'000, robot));
  EXPECT_EQ(robot.q, truth.robot.q);
  EXPECT_TRUE(robot.X_WE.isApprox(truth.robot.X_WE, 1e-12));
  EXPECT_TRUE(robot.V_W_E.vector().isApprox(truth.robot.V_W_E.vector(), 1e-12));
  ForceTorqueReading ft;
  ASSERT_TRUE(suite.take(10'000, ft));
  EXPECT_EQ(ft.wrench, truth.force_torque.wrench);
  HandReading hand;
  ASSERT_TRUE(suite.take(10'000, hand));
  EXPECT_TRUE(hand.holding);
  ASSERT_EQ(hand.X_ET.size(), 2u);
  EXPECT_TRUE(hand.X_ET[1].isApprox(grasp(), 1e-12));
}

TEST(SensorSuite, ATurnedSensorReadsInItsOwnAxes) {
  // Mounted with a quarter turn about z: its x is the link's y, its y the link's -x.
  const std::string scene =
      "{force_torque: {mounting_rotation_deg: [0, 0, 90], bias: [0.5, 0, 0, 0, 0, 0.1],"
      "  force: {step: 0, noise: 0}, torque: {step: 0, noise: 0}},"
      " imu: {mounting_rotation_deg: [90, 0, 0], acceleration: {step: 0, noise: 0},"
      "  angular_velocity: {step: 0, noise: 0}}}";
  SensorSuite suite(table(scene), 1, grasp(), 7);
  suite.sample(0, some_truth());
  ForceTorqueReading ft;
  ASSERT_TRUE(suite.take(10'000, ft));
  const math::Vector6d wrench = (math::Vector6d() << -2 + 0.5, -1, 47, -0.3, -0.1, 0.12).finished();
  EXPECT_LT((ft.wrench - wrench).norm(), 1e-12);
  InertialReading imu;
  ASSERT_TRUE(suite.take(100'000, imu));
  const math::Vector6d motion = (math::Vector6d() << 0.1, -0.4, -9.7, 0.3, 0.1, -0.2).finished();
  EXPECT_LT((imu.motion - motion).norm(), 1e-12);
}

TEST(SensorSuite, LateStampsAreThoseOfTheirSensorAlone) {
  SensorSuite suite(table("{force_torque: {delay: 0.021, stamp_delay: 0.02}}"), 1, grasp(), 7);
  suite.sample(5'000, some_truth());
  ForceTorqueReading ft;
  EXPECT_FALSE(suite.take(25'000, ft));  // it arrives after the time that it states
  ASSERT_TRUE(suite.take(26'000, ft));
  EXPECT_EQ(ft.time_us, 25'000);
  RobotReading robot;
  ASSERT_TRUE(suite.take(26'000, robot));
  EXPECT_EQ(robot.time_us, 5'000);
  EXPECT_THROW(table("{imu: {stamp_delay: 2}}"), config::Error);
  EXPECT_THROW(table("{imu: {mounting_rotation_deg: [0, 0]}}"), config::Error);
  EXPECT_THROW(table("{robot_state: {mounting_rotation_deg: [0, 0, 1]}}"), config::Error);
}

TEST(SensorSuite, KinematicsErrorShowsAtTheGrasp) {
  const std::string scene =
      kClean + ", kinematics_error: {position: [0.001, 0, 0], rpy_deg: [0, 0.5, 0]}}";
  SensorSuite suite(table(scene), 1, grasp(), 7);
  const Truth truth = some_truth();
  suite.sample(0, truth);
  RobotReading robot;
  ASSERT_TRUE(suite.take(10'000, robot));
  const math::Pose X_WG = truth.robot.X_WE * grasp(), reported = robot.X_WE * grasp();
  const math::Pose error = X_WG.inverse() * reported;
  EXPECT_LT((error.translation() - Eigen::Vector3d(0.001, 0, 0)).norm(), 1e-12);
  EXPECT_LT((math::log_rotation(error.linear()) - Eigen::Vector3d(0, 0.5 * M_PI / 180, 0)).norm(),
            1e-9);

  // The twist is the derivative of the reported pose.
  Truth later = truth;
  const double dt = 1e-6;
  later.robot.X_WE.translation() += dt * truth.robot.V_W_E.linear;
  later.robot.X_WE.linear() =
      math::exp_rotation(dt * truth.robot.V_W_E.angular) * truth.robot.X_WE.linear();
  suite.sample(20'000, later);
  RobotReading next;
  ASSERT_TRUE(suite.take(30'000, next));
  EXPECT_LT(((next.X_WE.translation() - robot.X_WE.translation()) / dt - robot.V_W_E.linear).norm(),
            1e-5);
}

TEST(SensorSuite, ReportedPoseBelongsToTheReportedJoints) {
  SensorSuite suite(table("{robot_state: {position: {step: 0, noise: 0.001}}}"), 1, grasp(), 7);
  const Truth truth = some_truth();
  suite.sample(0, truth);
  RobotReading robot;
  ASSERT_TRUE(suite.take(10'000, robot));
  const math::Vector6d moved = truth.jacobian * (robot.q - truth.robot.q);
  EXPECT_GT(moved.norm(), 1e-4);
  EXPECT_LT((robot.X_WE.translation() - truth.robot.X_WE.translation() - moved.head<3>()).norm(),
            1e-12);
}

TEST(SensorSuite, OneSeedGivesOneRunAndSensorsAreIndependent) {
  const auto first_wrench = [](const SensorTable& t, std::uint64_t seed) {
    SensorSuite suite(t, seed, grasp(), 7);
    suite.sample(0, some_truth());
    ForceTorqueReading r;
    EXPECT_TRUE(suite.take(10'000, r));
    return r.wrench;
  };
  EXPECT_EQ(first_wrench(table(), 5), first_wrench(table(), 5));
  EXPECT_NE(first_wrench(table(), 5), first_wrench(table(), 6));
  EXPECT_EQ(first_wrench(table(), 5), first_wrench(table("{imu: {rate: 50}}"), 5));
}

TEST(SensorSuite, FingertipsThatTouchHaveBiotacs) {
  SensorSuite suite(table(), 1, grasp(), 7);
  Truth truth = some_truth();
  BiotacReading reading;
  suite.sample(1000, truth);
  EXPECT_FALSE(suite.take(100'000, 0, reading)) << "no fingertips in the scene";
  truth.touches.resize(2);
  truth.touches[1] = {{{-7e-3, 0, -7e-3}, {0, 0, 1}, 3e-3}};
  int count = 0, idle = 0, pressed = 0;
  for (std::int64_t now = 2000; now <= 1'001'000; now += 1000) {
    suite.sample(now, truth);
    while (suite.take(now, 0, reading)) {
      ++count;
      idle = reading.pdc;
    }
    while (suite.take(now, 1, reading)) pressed = reading.pdc;
  }
  EXPECT_NEAR(count, 100, 1);
  EXPECT_NEAR(pressed - idle, 128, 210) << "two sensors rest at unlike counts";
  EXPECT_FALSE(suite.take(2'000'000, 2, reading));
  truth.touches.resize(6);
  EXPECT_THROW(suite.sample(1'002'000, truth), std::invalid_argument);
}

TEST(SensorSuite, FingertipsReportForceAndCentreOfTheirTouches) {
  SensorSuite suite(table("{fingertip: {place: {noise: 0}, force: {noise: 0}, rate: 50}}"), 1,
                    grasp(), 7);
  Truth truth = some_truth();
  truth.touches.resize(2);
  // Twice as much at the second place: the centre is two thirds of the way to it.
  truth.touches[1] = {{{-9e-3, 0, -7e-3}, {0, 0, 1}, 2e-3}, {{-3e-3, 0, -7e-3}, {0, 0, 2}, 1e-3}};
  int count = 0;
  FingertipReading idle, touched;
  for (std::int64_t now = 0; now <= 1'000'000; now += 1000) {
    suite.sample(now, truth);
    while (suite.take(now, 0, idle)) ++count;
    while (suite.take(now, 1, touched)) {
    }
  }
  EXPECT_NEAR(count, 50, 1);
  EXPECT_FALSE(idle.contact);
  EXPECT_EQ(idle.force, Eigen::Vector3d::Zero());
  EXPECT_TRUE(touched.contact);
  EXPECT_LT((touched.force - Eigen::Vector3d(0, 0, -3)).norm(), 1e-12) << "on the object";
  EXPECT_LT((touched.place - Eigen::Vector3d(-5e-3, 0, -7e-3)).norm(), 1e-12);
  EXPECT_LT((touched.normal - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
  EXPECT_NEAR(touched.area, M_PI * 5e-6, 1e-12);
}

ForceTorqueReading reading_at(SensorSuite& suite, std::int64_t now_us, const Truth& truth) {
  suite.sample(now_us, truth);
  ForceTorqueReading r;
  EXPECT_TRUE(suite.take(now_us + 100'000, r));
  return r;
}

/// No errors of the force-torque sensor except `more` and the torque's hysteresis.
SensorTable clean_but(const std::string& more, double hysteresis = 0) {
  return table(
      "{force_torque: {delay: 0, force: {step: 0, noise: 0}, torque: {step: 0, noise: 0, "
      "hysteresis: " +
      std::to_string(hysteresis) + "}, " + more + "}}");
}

TEST(ForceTorque, CablesPullTheHandBackToWhereItWas) {
  SensorSuite suite(clean_but("cable: {stiffness: 8, torsion: 0.3}"), 1, grasp(), 7);
  Truth truth = some_truth();
  truth.X_WS = some_pose();
  EXPECT_TRUE(reading_at(suite, 0, truth).wrench.isApprox(truth.force_torque.wrench, 1e-12));
  truth.X_WS.translation() += Eigen::Vector3d(0, 0.1, 0);
  truth.X_WS.linear() = math::exp_rotation({0, 0, 0.5}) * some_pose().linear();
  const math::Vector6d more =
      reading_at(suite, 1000, truth).wrench - truth.force_torque.wrench;  // sensor on hand, in S
  const Eigen::Matrix3d& R_WS = truth.X_WS.linear();
  EXPECT_TRUE((R_WS * more.head<3>()).isApprox(Eigen::Vector3d(0, 0.8, 0), 1e-9));
  EXPECT_TRUE((R_WS * more.tail<3>()).isApprox(Eigen::Vector3d(0, 0, 0.15), 1e-9));
}

TEST(ForceTorque, HysteresisHoldsTheReadingUntilTheLoadHasTurnedBackFarEnough) {
  SensorSuite suite(clean_but("drop_out: 0", 0.05), 1, grasp(), 7);
  Truth truth = some_truth();
  double& load = truth.force_torque.wrench(4);
  std::int64_t now = 0;
  const auto read = [&](double value) {
    load = value;
    return reading_at(suite, now += 1000, truth).wrench(4);
  };
  EXPECT_NEAR(read(0), 0, 1e-12);
  EXPECT_NEAR(read(0.04), 0, 1e-12);
  EXPECT_NEAR(read(1), 0.95, 1e-12);
  EXPECT_NEAR(read(0.92), 0.95, 1e-12);
  EXPECT_NEAR(read(0), 0.05, 1e-12);  // the hysteresis loop is twice as wide
  EXPECT_EQ(reading_at(suite, now += 1000, truth).wrench(0), truth.force_torque.wrench(0));
}

TEST(ForceTorque, TemperatureCarriesTheZeroAwayExponentially) {
  SensorSuite suite(clean_but("warm_up: {time: 20, wrench: [2, 0, 0, 0, 0, -0.1]}"), 1, grasp(), 7);
  const Truth truth = some_truth();
  const auto offset = [&](double seconds) -> math::Vector6d {
    return reading_at(suite, std::llround(1e6 * seconds), truth).wrench - truth.force_torque.wrench;
  };
  EXPECT_NEAR(offset(0)(0), 0, 1e-12);
  const math::Vector6d one = offset(20), long_after = offset(400);
  EXPECT_NEAR(one(0), 2 * (1 - std::exp(-1)), 1e-9);
  EXPECT_NEAR(one(5), -0.1 * (1 - std::exp(-1)), 1e-9);
  EXPECT_NEAR(long_after(0), 2, 1e-6);
  EXPECT_NEAR(long_after(1), 0, 1e-12);
}

}  // namespace
}  // namespace palpate::sensors
