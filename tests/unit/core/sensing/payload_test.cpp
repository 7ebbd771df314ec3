#include "core/sensing/payload.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/math/random.hpp"
#include "tests/unit/core/sensing/wrist_signals.hpp"

namespace palpate::sensing {
namespace {

const Eigen::Vector3d kGravity(0, 0, -9.81);

Eigen::Vector3d random_vector(math::Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}

PayloadParameters hand() {
  PayloadParameters payload;
  payload.mass = 4.8;
  payload.first_moment = 4.8 * Eigen::Vector3d(0.002, -0.003, 0.1137);
  payload.inertia << 0.09, 0.001, -0.002, 0.085, 0.003, 0.012;
  payload.bias = {{3, -7, 11}, {0.2, -0.4, 0.1}};
  return payload;
}

/// A body of point masses held by the sensor: Newton's law for each of them, and nothing else.
math::Wrench wrench_of_points(const std::vector<std::pair<double, Eigen::Vector3d>>& points,
                              const LoadMotion& motion) {
  math::Wrench wrench;
  for (const auto& [mass, p] : points) {
    const Eigen::Vector3d& omega = motion.angular_velocity;
    const Eigen::Vector3d force =
        mass * (motion.specific_force + motion.angular_acceleration.cross(p) +
                omega.cross(omega.cross(p)));
    wrench.force += force;
    wrench.torque += p.cross(force);
  }
  return wrench;
}

TEST(LoadWrench, IsThatOfABodyOfPointMasses) {
  math::Random random(1);
  std::vector<std::pair<double, Eigen::Vector3d>> points;
  PayloadParameters payload;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 20; ++i) {
    const double mass = random.uniform(0.1, 1);
    const Eigen::Vector3d p = random_vector(random, 0.2);
    points.emplace_back(mass, p);
    payload.mass += mass;
    payload.first_moment += mass * p;
    inertia -= mass * math::cross_matrix(p) * math::cross_matrix(p);
  }
  payload.inertia << inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2),
      inertia(2, 2);
  for (int i = 0; i < 10; ++i) {
    LoadMotion motion;
    motion.specific_force = random_vector(random, 20);
    motion.angular_velocity = random_vector(random, 5);
    motion.angular_acceleration = random_vector(random, 30);
    const math::Vector6d error =
        load_wrench(payload, motion).vector() - wrench_of_points(points, motion).vector();
    EXPECT_LT(error.norm(), 1e-12 * 1000);
  }
}

TEST(LoadWrench, OfASinglePointHasPointInertia) {
  math::Random random(2);
  const Eigen::Vector3d p(0.02, -0.03, 0.1137);
  PayloadParameters payload;
  payload.mass = 4.8;
  payload.first_moment = payload.mass * p;
  payload.inertia = point_inertia(payload.mass, payload.first_moment);
  LoadMotion motion;
  motion.specific_force = random_vector(random, 20);
  motion.angular_velocity = random_vector(random, 5);
  motion.angular_acceleration = random_vector(random, 30);
  const math::Vector6d error =
      load_wrench(payload, motion).vector() - wrench_of_points({{4.8, p}}, motion).vector();
  EXPECT_LT(error.norm(), 1e-12 * 1000);
  EXPECT_EQ(point_inertia(0, Eigen::Vector3d::Zero()), math::Vector6d(math::Vector6d::Zero()));
}

TEST(LoadWrench, HoldsAHangingWeightUp) {
  PayloadParameters payload;
  payload.mass = 2;
  payload.first_moment = {0.2, 0, 0};  // 0.1 m along x
  const math::Wrench wrench =
      load_wrench(payload, motion_at_rest(Eigen::Matrix3d::Identity(), kGravity));
  EXPECT_LT((wrench.force - Eigen::Vector3d(0, 0, 19.62)).norm(), 1e-12);
  EXPECT_LT((wrench.torque - Eigen::Vector3d(0, -1.962, 0)).norm(), 1e-12);
}

TEST(LoadWrench, FallingFreelyWeighsNothing) {
  const Eigen::Matrix3d R_WS = math::exp_rotation({0.3, -1, 2});
  const LoadMotion motion =
      motion_from_world(R_WS, kGravity, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), kGravity);
  PayloadParameters payload = hand();
  payload.bias = {};
  EXPECT_LT(load_wrench(payload, motion).vector().norm(), 1e-12);
}

TEST(LoadRegressor, TimesTheParametersIsTheWrench) {
  math::Random random(2);
  const PayloadParameters payload = hand();
  EXPECT_EQ(to_vector(payload_from_vector(to_vector(payload))), to_vector(payload));
  for (int i = 0; i < 10; ++i) {
    LoadMotion motion;
    motion.specific_force = random_vector(random, 20);
    motion.angular_velocity = random_vector(random, 5);
    motion.angular_acceleration = random_vector(random, 30);
    const math::Vector6d error =
        load_regressor(motion) * to_vector(payload) - load_wrench(payload, motion).vector();
    EXPECT_LT(error.norm(), 1e-11);
  }
}

std::vector<MotionSample> motion_samples(const PayloadParameters& payload, bool turning,
                                         int seed = 7) {
  math::Random random(seed);
  std::vector<MotionSample> samples;
  for (int i = 0; i < 400; ++i) {
    MotionSample sample;
    sample.motion = motion_at_rest(math::exp_rotation(random_vector(random, 2.5)), kGravity);
    sample.motion.specific_force += random_vector(random, 2);
    if (turning) {
      sample.motion.angular_velocity = random_vector(random, 2);
      sample.motion.angular_acceleration = random_vector(random, 15);
    }
    sample.F_S = load_wrench(payload, sample.motion);
    for (int axis = 0; axis < 3; ++axis) {
      sample.F_S.force[axis] += 0.025 * random.normal();
      sample.F_S.torque[axis] += 0.001 * random.normal();
    }
    samples.push_back(sample);
  }
  return samples;
}

TEST(IdentifyPayload, RecoversAllInertialParametersWithinOnePercent) {
  const PayloadParameters truth = hand();
  const PayloadFit fit = identify_payload(motion_samples(truth, true));
  EXPECT_NEAR(fit.parameters.mass, truth.mass, 0.01 * truth.mass);
  EXPECT_LT((fit.parameters.center_of_mass() - truth.center_of_mass()).norm(),
            0.01 * truth.center_of_mass().norm());
  EXPECT_LT((fit.parameters.inertia - truth.inertia).norm(), 0.01 * truth.inertia.norm());
  EXPECT_TRUE(fit.unidentified.empty());
}

TEST(IdentifyPayload, NamesTheInertiaThatOnlyTurningDetermines) {
  const PayloadFit fit = identify_payload(motion_samples(hand(), false));
  EXPECT_THAT(fit.unidentified,
              testing::UnorderedElementsAre("inertia_xx", "inertia_xy", "inertia_xz", "inertia_yy",
                                            "inertia_yz", "inertia_zz"));
  EXPECT_NEAR(fit.parameters.mass, 4.8, 0.048);
}

/// The standard deviations are correct: errors of many trials divided by them have unit variance.
TEST(IdentifyPayload, DeviationsMatchTheSpreadOfManyTrials) {
  const PayloadParameters truth = hand();
  PayloadVector normalised = PayloadVector::Zero();
  const int trials = 100;
  for (int trial = 0; trial < trials; ++trial) {
    const PayloadFit fit = identify_payload(motion_samples(truth, true, 100 + trial));
    const PayloadVector error = to_vector(fit.parameters) - to_vector(truth);
    normalised += (error.array() / fit.deviation.array()).square().matrix() / trials;
  }
  for (int i = 0; i < kPayloadParameterCount; ++i) {
    EXPECT_GT(normalised[i], 0.6) << payload_parameter_name(i);
    EXPECT_LT(normalised[i], 1.6) << payload_parameter_name(i);
  }
}

TEST(IdentifyPayload, NamesWhatOneOrientationCannotDetermine) {
  const MotionSample at_rest{
      motion_at_rest(Eigen::Matrix3d::Identity(), kGravity),
      load_wrench(hand(), motion_at_rest(Eigen::Matrix3d::Identity(), kGravity))};
  const PayloadFit fit = identify_payload(std::vector<MotionSample>(8, at_rest));
  EXPECT_THAT(fit.unidentified, testing::IsSupersetOf({"mass", "bias_fz", "mass*com_z"}));
  EXPECT_THAT(fit.unidentified, testing::Not(testing::Contains("bias_fx")));
  EXPECT_LT(fit.force_rms, 1e-9);  // and nevertheless explains every reading
}

TEST(IdentifyPayload, RefusesTooFewReadingsAndNumbersThatAreNotFinite) {
  std::vector<MotionSample> samples = motion_samples(hand(), true);
  samples[2].F_S.force.x() = NAN;
  EXPECT_THROW(identify_payload(samples), std::invalid_argument);
  samples.resize(2);
  EXPECT_THROW(identify_payload(samples), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing
