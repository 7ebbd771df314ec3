#include "core/sensing/ft_rnnob.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/core/sensing/scripted_executor.hpp"
#include "tests/unit/core/sensing/wrist_signals.hpp"

namespace palpate::sensing {
namespace {

const Eigen::Vector3d kFtRnnobGravity(0, 0, -9.81);
const Eigen::Vector3d kContact(0.5, -1, 2);  // N, on the object

/// A sensor that rotates about y and is shaken, 1 kHz; readings and inertial samples are delayed.
class FtRnnobTest : public ::testing::Test {
 protected:
  FtRnnobTest() {
    options_.payload.mass = 1.2;
    options_.payload.first_moment = {0.01, -0.02, 0.12};
    options_.payload.inertia << 0.02, 0, 0, 0.02, 0, 0.01;
    options_.inputs = {observer_input_index("gravity_x"), observer_input_index("gravity_z")};
    options_.average = 0.02;
    options_.X_ES = math::make_pose(math::exp_rotation({0, 0, 0.4}), {0, 0, 0.05});
    options_.X_EI = math::make_pose(math::exp_rotation({0.3, 0, 0}), {0.02, -0.01, 0.03});
    script_.sizes = {2, 0, 6};
    script_.answer = [](const float* x, float* y) {
      for (int i = 0; i < 6; ++i) y[i] = 0;
      y[0] = 3 * x[0], y[4] = x[1];
    };
  }

  FtRnnob make() { return FtRnnob(options_, std::make_unique<ScriptedExecutor>(script_)); }

  Eigen::Matrix3d R_WS(double t) const { return math::exp_rotation({0, angle(t), 0}); }
  static double angle(double t) { return 0.6 * std::sin(2 * t); }
  static double rate(double t) { return 1.2 * std::cos(2 * t); }
  static double turn(double t) { return -2.4 * std::sin(2 * t); }
  static Eigen::Vector3d acceleration(double t) { return {1.5 * std::sin(3 * t), 0, 0}; }  // of S

  LoadMotion motion(double t) const {
    return motion_from_world(R_WS(t), acceleration(t), {0, rate(t), 0}, {0, turn(t), 0},
                             kFtRnnobGravity);
  }
  /// Reading of S at t: payload, the network's output, and the contact.
  math::Vector6d reading(double t) const {
    math::Vector6d wrench = load_wrench(options_.payload, motion(t)).vector();
    const Eigen::Vector3d gravity_S = R_WS(t).transpose() * kFtRnnobGravity.normalized();
    wrench[0] += 3 * gravity_S.x();
    wrench[4] += gravity_S.z();
    wrench.head<3>() += kContact;
    return wrench;
  }

  UpdateResult tick(FtRnnob& sensor) {
    const math::Pose X_ES = options_.X_ES;
    RobotState robot;
    robot.X_WE.linear() = R_WS(time_) * X_ES.linear().transpose();
    robot.V_W_E.angular = {0, rate(time_), 0};
    feed(signals_.robot, robot);

    const double t_I = time_ - inertial_lag_;
    const math::Pose X_SI = X_ES.inverse() * options_.X_EI;
    const LoadMotion of_S = motion(t_I);
    const Eigen::Vector3d p = X_SI.translation();
    Inertial inertial;
    inertial.acceleration_I =
        X_SI.linear().transpose() * (of_S.specific_force + of_S.angular_acceleration.cross(p) +
                                     of_S.angular_velocity.cross(of_S.angular_velocity.cross(p)));
    inertial.angular_velocity_I = X_SI.linear().transpose() * of_S.angular_velocity;
    feed(signals_.inertial, inertial);

    ForceTorque wrench;
    wrench.F_S = math::Wrench::from(options_.polarity * reading(time_ - wrench_lag_));
    feed(signals_.force_torque, wrench);
    time_ += 1e-3;
    return sensor.update(signals_, contacts_ = {});
  }
  /// Largest error of the contact, N and 10 N m, over two seconds of motion.
  double largest_error(FtRnnob& sensor) {
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
      static_cast<void>(tick(sensor));
      if (i < 200) continue;
      EXPECT_EQ(contacts_.count, 1);
      const math::Wrench& found = contacts_.contacts[0].wrench;
      largest = std::max({largest, (found.force - kContact).norm(), 10 * found.torque.norm()});
    }
    return largest;
  }

  FtRnnob::Options options_;
  Script script_;
  Signals signals_;
  ContactSet contacts_;
  double time_ = 0;
  double inertial_lag_ = 0, wrench_lag_ = 0;
};

TEST_F(FtRnnobTest, TakesPayloadAndNetworkOutOfTheReading) {
  FtRnnob sensor = make();
  EXPECT_LT(largest_error(sensor), 0.05);
  EXPECT_NEAR(script_.steps, 200, 1);  // every tenth tick
}

TEST_F(FtRnnobTest, AlignsStreamsByTheirDelays) {
  inertial_lag_ = 0.0304;
  wrench_lag_ = 0.0507;
  {
    FtRnnob sensor = make();
    EXPECT_GT(largest_error(sensor), 0.3);
  }
  time_ = 0;
  options_.inertial_delay = inertial_lag_;
  options_.force_torque_delay = wrench_lag_;
  FtRnnob sensor = make();
  EXPECT_LT(largest_error(sensor), 0.05);
}

TEST_F(FtRnnobTest, AStreamMayLead) {
  inertial_lag_ = -0.02;
  options_.inertial_delay = inertial_lag_;
  FtRnnob sensor = make();
  EXPECT_LT(largest_error(sensor), 0.05);
}

TEST_F(FtRnnobTest, FarFromItsTrainingThePayloadAloneIsLeft) {
  options_.domain.points = Eigen::Vector2d(0, -1);  // upright
  options_.domain.deviation = Eigen::Vector2d(1, 1);
  options_.domain.near = 0.1;
  options_.domain.far = 0.3;
  Script nothing = script_;
  nothing.answer = [](const float*, float* y) { std::fill_n(y, 6, 0.f); };
  FtRnnob silent(options_, std::make_unique<ScriptedExecutor>(nothing));
  script_.answer = [](const float*, float* y) { std::fill_n(y, 6, 2.f); };
  FtRnnob speaking = make();
  int far = 0, near = 0;
  for (int i = 0; i < 2000; ++i) {
    const double t = time_;
    ContactSet from_payload;
    static_cast<void>(tick(speaking));
    static_cast<void>(silent.update(signals_, from_payload));
    if (contacts_.count == 0) continue;
    const math::Vector6d part =
        from_payload.contacts[0].wrench.vector() - contacts_.contacts[0].wrench.vector();
    const double chord = 2 * std::sin(std::abs(angle(t - options_.average / 2)) / 2);
    if (chord > 0.33) {
      EXPECT_EQ(part, math::Vector6d::Zero());
      ++far;
    } else if (chord < 0.07) {
      EXPECT_TRUE(part.isApproxToConstant(2, 1e-9));
      ++near;
    }
  }
  EXPECT_GT(far, 200);
  EXPECT_GT(near, 50);
  options_.network_gives_rest = false;
  EXPECT_THROW(make(), std::invalid_argument);
}

TEST_F(FtRnnobTest, PolarityTurnsTheReading) {
  options_.polarity = -1;
  FtRnnob sensor = make();
  EXPECT_LT(largest_error(sensor), 0.05);
}

TEST_F(FtRnnobTest, TareTakesTheContactOfItsTimeForZero) {
  options_.tare_at_start = true;
  options_.tare_samples = 20;
  FtRnnob sensor = make();
  EXPECT_STREQ(tick(sensor).reason, "taring");
  for (int i = 0; i < 400; ++i) static_cast<void>(tick(sensor));
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_LT(contacts_.contacts[0].wrench.force.norm(), 0.1);
}

TEST_F(FtRnnobTest, AFaultIsSaidOrThePayloadServesAlone) {
  {
    FtRnnob sensor = make();
    for (int i = 0; i < 100; ++i) static_cast<void>(tick(sensor));
    script_.says = Answer::kFault;
    UpdateResult result;
    for (int i = 0; i < 11; ++i) result = tick(sensor);
    EXPECT_EQ(result.status, Status::kFault);
    EXPECT_EQ(contacts_.count, 0);
    script_.says = Answer::kFresh;
    for (int i = 0; i < 11; ++i) result = tick(sensor);
    EXPECT_EQ(result.status, Status::kFault);
    sensor.reset();
    EXPECT_LT(largest_error(sensor), 0.05);
  }
  options_.fall_back = true;
  FtRnnob sensor = make();
  script_.says = Answer::kFault;
  UpdateResult result;
  for (int i = 0; i < 100; ++i) result = tick(sensor);
  EXPECT_EQ(result.status, Status::kDegraded);
  ASSERT_EQ(contacts_.count, 1);
  const double t = time_ - 1e-3 - options_.average / 2;
  const Eigen::Vector3d gravity_S = R_WS(t).transpose() * kFtRnnobGravity.normalized();
  // The network's missing output remains in the result.
  EXPECT_NEAR(contacts_.contacts[0].wrench.force.x(), kContact.x() + 3 * gravity_S.x(), 0.05);
}

TEST_F(FtRnnobTest, LateAnswersServeUntilTheirOwnCome) {
  FtRnnob sensor = make();
  script_.says = Answer::kNone;
  for (int i = 0; i < 50; ++i) EXPECT_EQ(tick(sensor).status, Status::kDegraded);
  EXPECT_EQ(contacts_.count, 0);
  script_.says = Answer::kLate;
  for (int i = 0; i < 50; ++i) static_cast<void>(tick(sensor));
  EXPECT_EQ(contacts_.count, 1);
}

TEST_F(FtRnnobTest, StaleInputsDegradeAndRestartTheSequence) {
  FtRnnob sensor = make();
  for (int i = 0; i < 100; ++i) static_cast<void>(tick(sensor));
  const auto check = [&](auto& stream) {
    stream.age = 0.1;
    const int resets = script_.resets;
    EXPECT_EQ(sensor.update(signals_, contacts_ = {}).status, Status::kDegraded);
    EXPECT_EQ(contacts_.count, 0);
    EXPECT_EQ(script_.resets, resets + 1);
    stream.age = 0;
    EXPECT_EQ(tick(sensor).status, Status::kOk);
    EXPECT_EQ(contacts_.count, 1);
  };
  check(signals_.robot);
  check(signals_.inertial);
  check(signals_.force_torque);
}

TEST_F(FtRnnobTest, NumbersThatAreNotFiniteNeverLeave) {
  FtRnnob sensor = make();
  for (int i = 0; i < 100; ++i) static_cast<void>(tick(sensor));
  signals_.force_torque.fresh[0].F_S.force.x() = NAN;
  signals_.inertial.fresh[0].acceleration_I.y() = INFINITY;
  for (int i = 0; i < 20; ++i) static_cast<void>(sensor.update(signals_, contacts_ = {}));
  EXPECT_EQ(sensor.skipped(), 40);
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_TRUE(contacts_.contacts[0].wrench.vector().allFinite());
  script_.answer = [](const float*, float* y) { std::fill_n(y, 6, NAN); };
  UpdateResult result;
  for (int i = 0; i < 11; ++i) result = tick(sensor);
  EXPECT_EQ(result.status, Status::kFault);
  EXPECT_EQ(contacts_.count, 0);
}

TEST_F(FtRnnobTest, RefusesARateThatTheLoopCannotKeep) {
  options_.rate = 300;
  EXPECT_THROW(make(), std::invalid_argument);
  options_.rate = 2000;
  EXPECT_THROW(make(), std::invalid_argument);
  options_.rate = 100;
  options_.inputs = {0};
  EXPECT_THROW(make(), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing
