#include "core/sensing/biotac_lstm.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/sensing/scripted_executor.hpp"

namespace palpate::sensing {
namespace {

constexpr int kE17 = 16, kPdc = kElectrodeCount + 1;

BioTac at_rest() {
  BioTac sample;
  sample.electrodes.setConstant(3200);
  sample.pac = 2030;
  sample.pdc = 1970;
  return sample;
}

/// A finger whose network outputs 1 mN along -z per count of PDC.
class BiotacLstmTest : public ::testing::Test {
 protected:
  BiotacLstmTest() {
    force_.sizes = {1, 0, 3};
    force_.answer = [](const float* x, float* y) { y[0] = y[1] = 0, y[2] = -1e-3f * x[0]; };
    direction_.sizes = {1, 0, 3};
    direction_.answer = [](const float*, float* y) { y[0] = 0, y[1] = 1, y[2] = 0; };
    options_.finger = 2;
    options_.inputs = {kPdc};
    options_.tare_samples = 3;
  }

  BiotacLstm make(bool with_direction = false) {
    std::optional<BiotacLstm::Direction> direction;
    if (with_direction) {
      direction = BiotacLstm::Direction{};
      direction->executor = std::make_unique<ScriptedExecutor>(direction_);
      direction->inputs = {kPdc};
      direction->R_TN = math::exp_rotation(-M_PI / 2 * Eigen::Vector3d::UnitX());  // y to -z
    }
    return BiotacLstm(options_, std::make_unique<ScriptedExecutor>(force_), std::move(direction));
  }

  UpdateResult feed(BiotacLstm& sensor, const BioTac& sample, double interval = 0.01) {
    auto& stream = signals_.biotac[2];
    stream.freshness = Freshness::kNew;
    stream.age = 0;
    stream.latest = stream.fresh[0] = sample;
    stream.latest.time = stream.fresh[0].time = time_ += interval;
    stream.fresh_count = 1;
    return sensor.update(signals_, contacts_ = {});
  }
  void tare(BiotacLstm& sensor) {
    for (int i = 0; i < 3; ++i) static_cast<void>(feed(sensor, at_rest()));
  }
  UpdateResult press(BiotacLstm& sensor, double pdc, double electrode = 40) {
    BioTac sample = at_rest();
    sample.pdc += pdc;
    sample.electrodes[kE17] += electrode;
    return feed(sensor, sample);
  }

  Script force_, direction_;
  BiotacLstm::Options options_;
  Signals signals_;
  ContactSet contacts_;
  double time_ = 0;
};

TEST_F(BiotacLstmTest, StepsOnceASampleOnceItIsTared) {
  BiotacLstm sensor = make();
  static_cast<void>(feed(sensor, at_rest()));
  EXPECT_STREQ(feed(sensor, at_rest()).reason, "taring");
  EXPECT_EQ(force_.steps, 0);
  static_cast<void>(feed(sensor, at_rest()));
  EXPECT_EQ(force_.steps, 1);
  static_cast<void>(press(sensor, 200));
  EXPECT_EQ(force_.steps, 2);
  const Contact first = contacts_.contacts[0];
  signals_.biotac[2].fresh_count = 0;  // the loop is faster than the sensor
  EXPECT_EQ(sensor.update(signals_, contacts_ = {}).status, Status::kOk);
  EXPECT_EQ(force_.steps, 2);
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_EQ(contacts_.contacts[0].wrench.force, first.wrench.force);
  EXPECT_EQ(contacts_.contacts[0].location, first.location);
}

TEST_F(BiotacLstmTest, ReportsForceAndPlaceBetweenItsGates) {
  BiotacLstm sensor = make();
  tare(sensor);
  static_cast<void>(press(sensor, 140));
  EXPECT_EQ(contacts_.count, 0);
  EXPECT_EQ(press(sensor, 200).status, Status::kOk);
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_EQ(contacts_.contacts[0].source, Source::kFinger2);
  EXPECT_NEAR(contacts_.contacts[0].wrench.force.z(), -0.2, 1e-6);
  EXPECT_LT((contacts_.contacts[0].location - Eigen::Vector3d(-2.8e-3, 0, -7e-3)).norm(), 1e-12);
  static_cast<void>(press(sensor, 110));
  EXPECT_EQ(contacts_.count, 1);
  static_cast<void>(press(sensor, 90));
  EXPECT_EQ(contacts_.count, 0);
}

TEST_F(BiotacLstmTest, WhatCannotBeIsShortenedAndSaid) {
  options_.largest_force = 2;
  BiotacLstm sensor = make();
  tare(sensor);
  const UpdateResult result = press(sensor, 5000);
  EXPECT_EQ(result.status, Status::kDegraded);
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_NEAR(contacts_.contacts[0].wrench.force.z(), -2, 1e-9);
  EXPECT_NEAR(sensor.force().z(), -5, 1e-5);
  EXPECT_EQ(press(sensor, 500).status, Status::kOk);
}

TEST_F(BiotacLstmTest, AFaultOfTheNetworkIsSaidUntilReset) {
  BiotacLstm sensor = make();
  tare(sensor);
  static_cast<void>(press(sensor, 300));
  force_.says = Answer::kFault;
  EXPECT_EQ(press(sensor, 300).status, Status::kFault);
  EXPECT_EQ(contacts_.count, 0);
  force_.says = Answer::kFresh;
  EXPECT_EQ(press(sensor, 300).status, Status::kFault);
  sensor.reset();
  tare(sensor);
  EXPECT_EQ(press(sensor, 300).status, Status::kOk);
}

TEST_F(BiotacLstmTest, NumbersThatAreNotFiniteNeverLeave) {
  BiotacLstm sensor = make();
  tare(sensor);
  BioTac broken = at_rest();
  broken.pdc = NAN;
  static_cast<void>(feed(sensor, broken));
  EXPECT_EQ(sensor.skipped(), 1);
  force_.answer = [](const float*, float* y) { y[0] = y[1] = y[2] = NAN; };
  EXPECT_EQ(press(sensor, 300).status, Status::kFault);
  EXPECT_EQ(contacts_.count, 0);
}

TEST_F(BiotacLstmTest, ASilentFingerDegradesAndRestartsItsSequence) {
  BiotacLstm sensor = make();
  EXPECT_EQ(sensor.update(signals_, contacts_).status, Status::kDegraded);
  tare(sensor);
  static_cast<void>(press(sensor, 300));
  const int resets = force_.resets;
  signals_.biotac[2].fresh_count = 0;
  signals_.biotac[2].age = 0.2;
  EXPECT_EQ(sensor.update(signals_, contacts_ = {}).status, Status::kDegraded);
  EXPECT_EQ(contacts_.count, 0);
  EXPECT_EQ(force_.resets, resets + 1);
  EXPECT_EQ(press(sensor, 300).status, Status::kOk);
  EXPECT_EQ(contacts_.count, 1);
}

TEST_F(BiotacLstmTest, SamplesAtAnotherRateAreSaid) {
  BiotacLstm sensor = make();
  tare(sensor);
  UpdateResult result;
  for (int i = 0; i < 100; ++i) result = feed(sensor, at_rest(), 0.02);
  EXPECT_EQ(result.status, Status::kDegraded);
  for (int i = 0; i < 200; ++i) result = feed(sensor, at_rest(), 0.01);
  EXPECT_EQ(result.status, Status::kOk);
}

TEST_F(BiotacLstmTest, ASecondNetworkPlacesTheContactByItsNormal) {
  BiotacLstm sensor = make(true);
  tare(sensor);
  static_cast<void>(press(sensor, 300, 40));
  ASSERT_EQ(contacts_.count, 1);
  // Its y is -z of T: below the centre of the pad, as high as the active electrode.
  EXPECT_LT((contacts_.contacts[0].location - Eigen::Vector3d(-2.8e-3, 0, -7e-3)).norm(), 1e-9);
  direction_.says = Answer::kFault;
  EXPECT_EQ(press(sensor, 300).status, Status::kDegraded);
  EXPECT_EQ(contacts_.count, 1);  // by the electrodes
  EXPECT_EQ(sensor.executor(2), nullptr);
  EXPECT_STREQ(sensor.executor(1)->kind(), "scripted");
}

TEST(PlaceOfNormal, FindsThePointWhoseNormalItIs) {
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(-5e-3, 3e-3, -4e-3), Eigen::Vector3d(2e-3, 3e-3, -4e-3),
        Eigen::Vector3d(0, 1e-3, -4e-3), Eigen::Vector3d(4e-3, 0, -1e-3)}) {
    const Eigen::Vector3d on_skin = project_on_skin(p);
    EXPECT_LT((place_of_normal(2 * skin_normal(on_skin), on_skin) - on_skin).norm(), 1e-12);
  }
}

TEST(ElectrodeScatter, HasTheVarianceOfItsIntensityInTheElectrodesPlane) {
  ElectrodeVector counts = ElectrodeVector::Zero();
  counts[kE17] = 50;
  LocalizationOptions options;  // intensity 0.5 of 100 counts
  math::Random random(3);
  const auto spread = [&](ElectrodeScatter scatter, int electrode) {
    double sum = 0, off_plane = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d d =
          1e3 * (scatter_electrodes(counts, options, scatter, random).col(electrode) -
                 electrode_positions().col(electrode));
      sum += d.squaredNorm();
      off_plane = std::max(off_plane, std::abs(d.dot(electrode_normals().col(electrode))));
    }
    EXPECT_LT(off_plane, 1e-9);
    return sum / kDraws / 2;  // mm^2, of a component
  };
  EXPECT_EQ(spread(ElectrodeScatter::kNominal, kE17), 0);
  EXPECT_NEAR(spread(ElectrodeScatter::kGaussian, kE17), 0.55, 0.03);
  EXPECT_NEAR(spread(ElectrodeScatter::kInvertedGaussian, kE17), 0.55, 0.03);
  EXPECT_NEAR(spread(ElectrodeScatter::kGaussian, 0), 0.1, 0.01);
  EXPECT_NEAR(spread(ElectrodeScatter::kInvertedGaussian, 0), 1.0, 0.06);
}

}  // namespace
}  // namespace palpate::sensing
