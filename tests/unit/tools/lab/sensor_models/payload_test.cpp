#include "tools/lab/sensor_models/payload.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/recordings.hpp"

namespace palpate::sensor_models {
namespace {

TEST(Payload, ExplainsTheStaticPosesOfTheAti) {
  PALPATE_REQUIRE_RECORDING("ft_static_ati");
  const PayloadScore score = score_static_ati(support::recordings());
  EXPECT_LE(score.fit.force_rms, 0.55);
  EXPECT_LE(score.left_out_force, 0.55);  // also at poses not used in the fit
  EXPECT_NEAR(score.fit.parameters.mass, 1.2, 0.1);
  // Without the drift, one axis causes three quarters of the error.
  const PayloadScore constant = score_static_ati_constant_bias(support::recordings());
  EXPECT_GT(constant.fit.force_rms, 4 * score.fit.force_rms);
}

TEST(Payload, ExplainsTheStaticPosesOfTheMeca500) {
  PALPATE_REQUIRE_RECORDING("ft_static_meca500");
  const PayloadScore score = score_static_meca500(support::recordings());
  EXPECT_LE(score.fit.force_rms, 0.09);
  EXPECT_LE(score.left_out_force, 0.09);
  EXPECT_NEAR(score.fit.parameters.mass, 0.282, 0.01);
  EXPECT_LT(
      (score.fit.parameters.center_of_mass() - Eigen::Vector3d(0.0255, -0.0003, 0.0233)).norm(),
      1e-3);
}

TEST(Payload, ExplainsTheStaticPosesOfTheKuka) {
  PALPATE_REQUIRE_RECORDING("ft_imu_kuka_ntnu");
  const PayloadScore score = score_static_ntnu(support::recordings());
  for (int axis = 0; axis < 3; ++axis) EXPECT_LE(score.fit.residual_rms[axis], 0.15) << axis;
  EXPECT_NEAR(score.fit.parameters.mass, 0.9323, 0.005);
}

TEST(Payload, MotionAgreesWithTheStaticPosesAndNeedsTheInertialUnit) {
  PALPATE_REQUIRE_RECORDING("ft_imu_kuka_ntnu");
  const PayloadScore still = score_static_ntnu(support::recordings());
  const PayloadScore moving = score_motion_ntnu(support::recordings());
  const PayloadScore gravity = score_motion_ntnu_gravity(support::recordings());
  EXPECT_NEAR(moving.fit.parameters.mass, still.fit.parameters.mass, 0.02);
  EXPECT_LT((moving.fit.parameters.center_of_mass() - still.fit.parameters.center_of_mass()).norm(),
            2e-3);
  EXPECT_LT(moving.fit.force_rms, 0.7 * gravity.fit.force_rms);
}

TEST(Payload, AFolderWithoutItsRecordingsIsAnError) {
  std::ostringstream out;
  EXPECT_THROW(run_payload({"/nowhere", ""}, out), std::runtime_error);
  EXPECT_NE(out.str().find("ft_static_ati: absent"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensor_models
