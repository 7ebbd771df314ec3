#include "sim/sensors/biotac.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace palpate::sensors {
namespace {

using Eigen::Vector3d;
using sensing::ElectrodeVector;
using sensing::kElectrodeCount;

constexpr double kPeriod = 0.01;  // s

BiotacTable quiet() {
  BiotacTable table;
  table.polarity = 1;
  return table;
}

Biotac make(const BiotacTable& table = quiet(), std::uint64_t seed = 3) {
  return {table, kPeriod, math::Random(seed)};
}

BiotacReading after(Biotac& biotac, double seconds, const std::vector<Touch>& touches) {
  BiotacReading reading;
  for (int i = 0; i < std::lround(seconds / kPeriod); ++i) {
    for (int k = 0; k < 10; ++k) biotac.step(kPeriod / 10, touches);
    reading = biotac.read();
  }
  return reading;
}

ElectrodeVector electrodes(const BiotacReading& reading) {
  ElectrodeVector counts;
  for (int i = 0; i < kElectrodeCount; ++i) counts[i] = reading.electrodes[i];
  return counts;
}

/// Perpendicular to the skin.
Touch biotac_press(const Vector3d& at, double newton, double radius = 2e-3) {
  const Vector3d location = sensing::project_on_skin(at);
  return {location, -newton * sensing::skin_normal(location), radius};
}

TEST(Biotac, AtRestItGivesItsRestCountsWithTheNoiseOfTheTable) {
  BiotacTable table = quiet();
  table.electrode.noise = 3;
  Biotac biotac = make(table);
  Eigen::MatrixXd all(kElectrodeCount, 2000);
  for (int i = 0; i < all.cols(); ++i) all.col(i) = electrodes(after(biotac, kPeriod, {}));
  const Eigen::VectorXd mean = all.rowwise().mean();
  EXPECT_GT(mean.minCoeff(), 2500);
  EXPECT_LT(mean.maxCoeff(), 3500);
  const double deviation =
      std::sqrt((all.colwise() - mean).squaredNorm() / static_cast<double>(all.size()));
  EXPECT_NEAR(deviation, std::hypot(3, std::sqrt(1.0 / 12)), 0.05);
}

TEST(Biotac, OneSeedGivesOneSensor) {
  BiotacTable table = quiet();
  table.electrode = {0, 2, 0.1};
  Biotac a = make(table, 7), b = make(table, 7), c = make(table, 8);
  const std::vector<Touch> touches{biotac_press({-5e-3, 0, -7e-3}, 1)};
  const BiotacReading of_a = after(a, 0.5, touches), of_b = after(b, 0.5, touches);
  EXPECT_EQ(of_a.electrodes, of_b.electrodes);
  EXPECT_EQ(of_a.pac, of_b.pac);
  EXPECT_NE(of_a.electrodes, after(c, 0.5, touches).electrodes);
}

TEST(Biotac, PressedElectrodesRiseOthersFallAndPolarityTurnsThat) {
  for (const double polarity : {1.0, -1.0}) {
    BiotacTable table = quiet();
    table.polarity = polarity;
    Biotac biotac = make(table);
    const ElectrodeVector rest = electrodes(after(biotac, 0.1, {}));
    const Vector3d e17 = sensing::electrode_positions().col(16);
    const ElectrodeVector change =
        polarity * (electrodes(after(biotac, 5, {biotac_press(e17, 1)})) - rest);
    int most = 0;
    change.maxCoeff(&most);
    EXPECT_EQ(most, 16);
    EXPECT_GT(change[16], 20);
    EXPECT_LT(change[18], 0) << "a centimetre away the fluid lifts the skin";
    EXPECT_GT(change[18], -20);
  }
}

TEST(Biotac, ClassicalLocalisationFindsTheTouch) {
  Biotac biotac = make();
  const ElectrodeVector rest = electrodes(after(biotac, 0.1, {}));
  sensing::LocalizationOptions options;
  options.threshold = 5;
  double sum = 0, worst = 0;
  int count = 0;
  for (double x = -12e-3; x <= 3e-3; x += 1.5e-3) {
    for (double angle = -0.8; angle <= 0.81; angle += 0.2) {
      const Vector3d at = sensing::project_on_skin({x, std::sin(angle), -std::cos(angle)});
      Biotac fresh = make();
      const ElectrodeVector change =
          electrodes(after(fresh, 0.5, {biotac_press(at, 1, 3e-3)})) - rest;
      const sensing::Localization found = sensing::locate_contact(change, options);
      ASSERT_GT(found.active, 0) << at.transpose();
      const double error = (found.location - at).norm();
      worst = std::max(worst, error);
      sum += error;
      ++count;
    }
  }
  EXPECT_LT(sum / count, 1.5e-3);
  EXPECT_LT(worst, 4e-3);
}

// As in the recording on foam: one point, a force that varies within a cone.
TEST(Biotac, ForceAtOneSpotIsNearlyLinearInTheCounts) {
  Biotac biotac = make();
  const ElectrodeVector rest = electrodes(after(biotac, 0.1, {}));
  math::Random random(4);
  const int samples = 400;
  Eigen::MatrixXd inputs(samples, kElectrodeCount + 1), forces(samples, 3);
  for (int i = 0; i < samples; ++i) {
    Touch touch = biotac_press({-7e-3, 1e-3, -7e-3}, random.uniform(0, 1.4), 4e-3);
    touch.force_T +=
        0.3 * touch.force_T.norm() * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    const BiotacReading reading = after(biotac, kPeriod, {touch});
    inputs.row(i) << (electrodes(reading) - rest).transpose(), reading.pdc;
    forces.row(i) = touch.force_T;
  }
  Eigen::MatrixXd with_offset(samples, kElectrodeCount + 2);
  with_offset << inputs, Eigen::VectorXd::Ones(samples);
  const Eigen::MatrixXd fit =
      with_offset.topRows(samples / 2).colPivHouseholderQr().solve(forces.topRows(samples / 2));
  const Eigen::MatrixXd error =
      with_offset.bottomRows(samples / 2) * fit - forces.bottomRows(samples / 2);
  EXPECT_LT(std::sqrt(error.squaredNorm() / (samples / 2.0)), 0.06);
}

TEST(Biotac, SkinCreepsPressureFollowsAndVibrationFades) {
  BiotacTable table = quiet();
  table.pressure_area = 2e-4;
  table.skin.fast_share = 0.05;
  table.skin.slow_share = 0.1;
  table.skin.slow_time = 1;
  Biotac biotac = make(table);
  const BiotacReading rest = after(biotac, 0.1, {});
  EXPECT_EQ(rest.pac[0], 2048);
  const std::vector<Touch> touches{biotac_press({-9.8e-3, 0, -7e-3}, 1.38, 4e-3)};
  const BiotacReading at_once = after(biotac, kPeriod, touches);
  EXPECT_GT(*std::max_element(at_once.pac.begin(), at_once.pac.end()), 3000);
  EXPECT_NEAR(at_once.pdc - rest.pdc, 1.38 / 2e-4 / 36.5, 1);
  const BiotacReading later = after(biotac, 6, touches);
  EXPECT_EQ(later.pac[0], 2048);
  const double first = at_once.electrodes[17] - rest.electrodes[17];
  const double last = later.electrodes[17] - rest.electrodes[17];
  EXPECT_NEAR(first / last, 0.86, 0.03);  // a tenth of the fast part has arrived, too
  const BiotacReading released = after(biotac, 10, {});
  EXPECT_NEAR(released.electrodes[17], rest.electrodes[17], 1);
}

TEST(Biotac, WarmsUpAndStaysWithinTwelveBits) {
  BiotacTable table = quiet();
  table.warm_up = 10;
  table.warm_up_electrode = 40;
  Biotac biotac = make(table);
  const int cold = after(biotac, kPeriod, {}).electrodes[4];
  EXPECT_NEAR(cold - after(biotac, 60, {}).electrodes[4], 40, 2);
  const BiotacReading crushed = after(biotac, 1, {biotac_press({0, 0, -7e-3}, 1e4)});
  for (const std::int16_t e : crushed.electrodes) {
    EXPECT_GE(e, 0);
    EXPECT_LE(e, 4095);
  }
  EXPECT_EQ(crushed.pdc, 4095);
}

TEST(Biotac, DividerGivesRestAndBothPolaritiesMoveApart) {
  EXPECT_NEAR(electrode_counts(3000, 1, 1), 3000, 1e-9);
  EXPECT_NEAR(electrode_counts(3000, 1, -1), 3000, 1e-9);
  EXPECT_GT(electrode_counts(3000, 1.2, 1), 3050);
  EXPECT_LT(electrode_counts(3000, 1.2, -1), 2950);
  EXPECT_LT(electrode_counts(3000, 1e9, 1), 4095.1);
}

}  // namespace
}  // namespace palpate::sensors
