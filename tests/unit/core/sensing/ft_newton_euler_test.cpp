#include "core/sensing/ft_newton_euler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math/random.hpp"
#include "tests/unit/core/sensing/wrist_signals.hpp"

namespace palpate::sensing {
namespace {

constexpr double kPeriod = 1e-3;
const Eigen::Vector3d kGravityDown(0, 0, -9.81);

/// A hand that shakes and rotates along known sines, its sensors read without error, while it
/// exerts a known wrench on the object.
struct ShakenHand {
  ShakenHand() {
    options.payload.mass = 4.8;
    options.payload.first_moment = 4.8 * Eigen::Vector3d(0.002, -0.003, 0.1137);
    options.payload.inertia << 0.09, 0.001, -0.002, 0.085, 0.003, 0.012;
    options.payload.bias = {{3, -7, 11}, {0.2, -0.4, 0.1}};
    options.gravity_W = kGravityDown;
    options.X_ES = math::make_pose(math::exp_rotation({0.2, 1, -0.4}), {0.01, 0.02, 0.04});
    options.X_EI = math::make_pose(math::exp_rotation({1, -0.5, 0.3}), {0.05, -0.03, 0.08});
    options.imu_offset_time = 0;
    options.angular_acceleration_time = 0;
  }

  math::Pose X_WE(double t) const {
    return math::make_pose(
        math::exp_rotation({0.5 + 0.3 * std::sin(3 * t), 0.2 * std::cos(2 * t), 0.4}),
        {0.1 * std::sin(4 * t), 0.05 * std::cos(5 * t), 0.3});
  }

  /// Angular velocity of E in W, by central difference of the rotation.
  Eigen::Vector3d omega_W(double t) const {
    constexpr double h = 1e-5;
    return math::log_rotation(X_WE(t + h).linear() * X_WE(t - h).linear().transpose()) / (2 * h);
  }

  Eigen::Vector3d acceleration_W(double t, const math::Pose& X_EP) const {
    constexpr double h = 1e-4;
    const auto p = [&](double s) { return Eigen::Vector3d((X_WE(s) * X_EP).translation()); };
    return (p(t + h) - 2 * p(t) + p(t - h)) / (h * h);
  }

  /// Signals at time t; `push` is the wrench of the hand on the object, at S, in S.
  void feed_all(Signals& signals, double t, const math::Wrench& push) const {
    const math::Pose X_WS = X_WE(t) * options.X_ES;
    constexpr double h = 1e-4;
    const Eigen::Vector3d alpha_W = (omega_W(t + h) - omega_W(t - h)) / (2 * h);
    const LoadMotion motion = motion_from_world(X_WS.linear(), acceleration_W(t, options.X_ES),
                                                omega_W(t), alpha_W, kGravityDown);
    const math::Wrench load = load_wrench(options.payload, motion);
    ForceTorque reading;
    reading.time = t;
    reading.F_S = {load.force + push.force, load.torque + push.torque};
    feed(signals.force_torque, reading);

    const Eigen::Matrix3d R_IW = (X_WE(t) * options.X_EI).linear().transpose();
    Inertial inertial;
    inertial.time = t;
    inertial.acceleration_I = R_IW * (acceleration_W(t, options.X_EI) - kGravityDown);
    inertial.angular_velocity_I = R_IW * omega_W(t);
    feed(signals.inertial, inertial);

    RobotState robot;
    robot.time = t;
    robot.X_WE = X_WE(t);
    robot.V_W_E.linear = (X_WE(t + h).translation() - X_WE(t - h).translation()) / (2 * h);
    robot.V_W_E.angular = omega_W(t);
    feed(signals.robot, robot);
  }

  FtNewtonEuler::Options options;
};

TEST(FtNewtonEuler, FindsThePushOfAShakenHand) {
  const ShakenHand hand;
  FtNewtonEuler with_imu(hand.options);
  FtNewtonEuler::Options no_imu = hand.options;
  no_imu.use_imu = false;
  FtNewtonEuler gravity_only(no_imu);
  const math::Wrench push{{1, -2, 0.5}, {0.05, 0.02, -0.01}};
  Signals signals;
  ContactSet contacts;
  double worst = 0, worst_gravity_only = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    hand.feed_all(signals, tick * kPeriod, push);
    static_cast<void>(with_imu.update(signals, contacts = {}));
    if (tick < 3) continue;  // the gyroscope must be differentiated first
    ASSERT_EQ(contacts.count, 1);
    EXPECT_TRUE(with_imu.used_imu());
    worst = std::max(worst, (contacts.contacts[0].wrench.force - push.force).norm());
    static_cast<void>(gravity_only.update(signals, contacts = {}));
    worst_gravity_only =
        std::max(worst_gravity_only, (contacts.contacts[0].wrench.force - push.force).norm());
  }
  EXPECT_LT(worst, 0.02);  // the gyroscope is differentiated half a sample late
  EXPECT_GT(worst_gravity_only, 3);
}

TEST(FtNewtonEuler, AJumpOfTheSendersClockLeavesNothingBehind) {
  ShakenHand hand;
  hand.options.imu_offset_time = 5;
  FtNewtonEuler steady(hand.options);
  for (const double jump : {3600.0, -3600.0, -0.5e-3, 0.5e-3}) {
    FtNewtonEuler jumped(hand.options);
    steady.reset();
    Signals signals;
    ContactSet contacts;
    double after = 0, then = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      hand.feed_all(signals, tick * kPeriod, {});
      static_cast<void>(steady.update(signals, contacts = {}));
      const Eigen::Vector3d expected =
          contacts.count == 1 ? contacts.contacts[0].wrench.force : Eigen::Vector3d::Zero();
      if (tick >= 500) signals.inertial.fresh[0].time += jump;
      static_cast<void>(jumped.update(signals, contacts = {}));
      if (tick < 500) continue;
      const double off = (contacts.contacts[0].wrench.force - expected).norm();
      (tick < 510 ? then : after) = std::max(tick < 510 ? then : after, off);
    }
    EXPECT_LT(then, 0.5) << jump;
    EXPECT_LT(after, 0.02) << jump;
  }
}

TEST(FtNewtonEuler, FollowsAnOffsetOfTheAccelerometer) {
  ShakenHand hand;
  hand.options.imu_offset_time = 5;
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  double sum = 0;
  int count = 0;
  for (int tick = 0; tick < 12000; ++tick) {
    hand.feed_all(signals, tick * kPeriod, {});
    signals.inertial.fresh[0].acceleration_I.x() += 0.3;  // 1.4 N for this hand
    static_cast<void>(sensor.update(signals, contacts = {}));
    if (tick < 6000) continue;
    sum += contacts.contacts[0].wrench.force.squaredNorm();
    ++count;
  }
  EXPECT_LT(std::sqrt(sum / count), 0.1);
}

TEST(FtNewtonEuler, AHandThatStartsInMotionHasNoOffset) {
  ShakenHand hand;
  hand.options.imu_offset_time = 5;
  FtNewtonEuler sensor(hand.options);
  math::Random random(1, "start");
  Signals signals;
  ContactSet contacts;
  double worst = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    hand.feed_all(signals, tick * kPeriod, {});
    for (int i = 0; i < 3; ++i) {  // as a robot reports it
      signals.robot.latest.V_W_E.linear[i] += 5e-4 * random.normal();
      signals.robot.latest.V_W_E.angular[i] += 1e-3 * random.normal();
    }
    static_cast<void>(sensor.update(signals, contacts = {}));
    if (tick >= 10) worst = std::max(worst, contacts.contacts[0].wrench.force.norm());
  }
  EXPECT_LT(worst, 0.3);  // the very first mean treats the hand's own 1 m/s^2 as an offset: 5 N
}

TEST(FtNewtonEuler, AnOverloadedAccelerometerIsNotTakenForAnOffset) {
  const ShakenHand hand;
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  const auto force = [&](int tick, double overload) {
    hand.feed_all(signals, tick * kPeriod, {});
    if (overload != 0) signals.inertial.fresh[0].acceleration_I.x() = overload;
    static_cast<void>(sensor.update(signals, contacts = {}));
    return contacts.count == 1 ? contacts.contacts[0].wrench.force.norm() : -1;
  };
  for (int tick = 0; tick < 300; ++tick) force(tick, 0);
  for (int tick = 300; tick < 600; ++tick) EXPECT_GT(force(tick, 157), 20);
  double largest = 0;
  for (int tick = 600; tick < 1500; ++tick) largest = std::max(largest, force(tick, 0));
  EXPECT_LT(largest, 2);
}

TEST(FtNewtonEuler, FallsBackOnGravityAndSaysSoWhenTheInertialUnitFallsSilent) {
  const ShakenHand hand;
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  hand.feed_all(signals, 0, {});
  static_cast<void>(sensor.update(signals, contacts = {}));
  hand.feed_all(signals, kPeriod, {});
  static_cast<void>(sensor.update(signals, contacts = {}));
  EXPECT_TRUE(sensor.used_imu());
  signals.inertial.freshness = Freshness::kOld;
  signals.inertial.fresh_count = 0;
  signals.inertial.age = 0.1;
  EXPECT_EQ(sensor.update(signals, contacts = {}).status, Status::kDegraded);
  EXPECT_FALSE(sensor.used_imu());
  EXPECT_EQ(contacts.count, 1);
}

TEST(FtNewtonEuler, SmoothsTheAccelerometersNoiseWhileTheHandRests) {
  const ShakenHand hand;
  FtNewtonEuler::Options options = hand.options;
  options.rest_speed = 1e-3;
  FtNewtonEuler sensor(options), plain(hand.options);
  math::Random random(1, "rest");
  Signals signals;
  ContactSet contacts, noisy;
  const auto spreads = [&](const Eigen::Vector3d& speed) {
    constexpr int kTicks = 6000, kFrom = 4000;
    Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = Eigen::Array2d::Zero();
    for (int tick = 0; tick < kTicks; ++tick) {
      hand.feed_all(signals, 0, {});
      signals.robot.latest.V_W_E = {speed, Eigen::Vector3d::Zero()};
      Inertial& inertial = signals.inertial.fresh[0];
      inertial.time = signals.robot.latest.time = tick * kPeriod;
      for (int i = 0; i < 3; ++i) inertial.acceleration_I[i] += 0.03 * random.normal();
      signals.inertial.latest = inertial;
      static_cast<void>(sensor.update(signals, contacts = {}));
      static_cast<void>(plain.update(signals, noisy = {}));
      if (tick < kFrom) continue;
      const Eigen::Array2d now(contacts.contacts[0].wrench.force.x(),
                               noisy.contacts[0].wrench.force.x());
      sum += now / (kTicks - kFrom);
      squares += now.square() / (kTicks - kFrom);
    }
    return Eigen::Array2d((squares - sum.square()).sqrt());
  };
  const Eigen::Array2d rests = spreads(Eigen::Vector3d::Zero());
  EXPECT_NEAR(rests[1], 0.03 * hand.options.payload.mass, 0.01 * hand.options.payload.mass);
  EXPECT_LT(rests[0], 0.1 * rests[1]);  // of white noise, sqrt(1 ms / 0.2 s) = 0.07 remains
  const Eigen::Array2d moves = spreads(Eigen::Vector3d(0, 3e-3, 0));
  EXPECT_NEAR(moves[0], moves[1], 0.01 * moves[1]) << "as without it";
}

TEST(FtNewtonEuler, AHandThatSetsOffIsNotSmoothed) {
  ShakenHand hand;
  hand.options.rest_speed = 10;  // judged by its speed it rests all the time
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  double worst = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    hand.feed_all(signals, tick * kPeriod, {});
    static_cast<void>(sensor.update(signals, contacts = {}));
    if (tick >= 3) worst = std::max(worst, contacts.contacts[0].wrench.force.norm());
  }
  // Of its 1 m/s^2, 5 N, and rotating; between one and two times 0.15 m/s^2 part of it stays
  // smoothed.
  EXPECT_LT(worst, 1);
}

TEST(FtNewtonEuler, AHandThatComesToRestLeavesNoForceBehind) {
  ShakenHand hand;
  hand.options.rest_speed = 1e-3;
  hand.options.imu_offset_time = 0;  // the speed drops without an acceleration
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  std::vector<Eigen::Vector3d> forces;
  for (int tick = 0; tick < 4000; ++tick) {
    // It shakes for two seconds, and then repeats the same readings.
    const bool moves = tick < 2000;
    hand.feed_all(signals, moves ? tick * kPeriod : 0, {});
    signals.robot.latest.V_W_E = {Eigen::Vector3d(moves ? 0.1 : 0, 0, 0), Eigen::Vector3d::Zero()};
    signals.inertial.fresh[0].time = signals.robot.latest.time = tick * kPeriod;
    signals.inertial.latest = signals.inertial.fresh[0];
    static_cast<void>(sensor.update(signals, contacts = {}));
    if (tick > 2150) forces.push_back(contacts.contacts[0].wrench.force);
  }
  double worst = 0;
  for (const Eigen::Vector3d& force : forces)
    worst = std::max(worst, (force - forces.back()).norm());
  EXPECT_LT(worst, 0.02);  // N, 0.15 s after the end of the motion
}

TEST(FtNewtonEuler, DegradesWithoutRobotState) {
  const ShakenHand hand;
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  hand.feed_all(signals, 0, {});
  signals.robot.age = 1;
  const UpdateResult result = sensor.update(signals, contacts);
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_EQ(contacts.count, 0);
}

TEST(FtNewtonEuler, TareRemovesWhatThePayloadDoesNotExplain) {
  ShakenHand hand;
  FtNewtonEuler::Options wrong = hand.options;
  wrong.payload.bias = {};
  wrong.tare_samples = 10;
  wrong.use_imu = false;
  FtNewtonEuler sensor(wrong);
  sensor.zero();
  Signals signals;
  ContactSet contacts;
  PayloadParameters payload = hand.options.payload;
  for (const double angle : {0.0, 1.2}) {  // tared in one orientation, used in another
    RobotState robot;
    robot.X_WE.linear() = math::exp_rotation({angle, 0, 0});
    feed(signals.robot, robot);
    const Eigen::Matrix3d R_WS = robot.X_WE.linear() * hand.options.X_ES.linear();
    feed_wrench(signals, load_wrench(payload, motion_at_rest(R_WS, kGravityDown)));
    for (int i = 0; i < 10; ++i) static_cast<void>(sensor.update(signals, contacts = {}));
    ASSERT_EQ(contacts.count, 1);
    EXPECT_LT(contacts.contacts[0].wrench.vector().norm(), 1e-10) << angle;
  }
}

TEST(FtNewtonEuler, PolarityTurnsASensorOfTheOtherConvention) {
  ShakenHand hand;
  hand.options.polarity = -1;
  hand.options.use_imu = false;
  FtNewtonEuler sensor(hand.options);
  Signals signals;
  ContactSet contacts;
  RobotState robot;
  feed(signals.robot, robot);
  const math::Wrench load =
      load_wrench(hand.options.payload, motion_at_rest(hand.options.X_ES.linear(), kGravityDown));
  feed_wrench(signals, {-(load.force + Eigen::Vector3d(1, 0, 0)), -load.torque});
  static_cast<void>(sensor.update(signals, contacts = {}));
  EXPECT_LT((contacts.contacts[0].wrench.force - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate::sensing
