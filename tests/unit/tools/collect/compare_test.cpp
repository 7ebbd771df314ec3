#include "tools/collect/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/recordings.hpp"
#include "tools/collect/nelder_mead.hpp"

namespace palpate::collect {
namespace {

TEST(NelderMead, FindsTheFloorOfABentValley) {
  const auto rosenbrock = [](const Eigen::VectorXd& x) {
    return std::pow(1 - x[0], 2) + 100 * std::pow(x[1] - x[0] * x[0], 2);
  };
  const Eigen::Vector2d found =
      minimise(rosenbrock, Eigen::Vector2d(-1.2, 1), Eigen::Vector2d(0.5, 0.5), 400);
  EXPECT_LT((found - Eigen::Vector2d(1, 1)).norm(), 1e-3);
}

sensors::BiotacTable normative() {
  return sensors::read_sensors(config::Node::from_text("{}")).biotac;
}

// A press that the emulation itself made: its place comes back.
TEST(Compare, FindsThePlaceOfAnEmulatedPress) {
  PressRecording recording;
  const int rows = 400;
  recording.time = Eigen::VectorXd::LinSpaced(rows, 0, 8);
  recording.forces.resize(rows, 3);
  for (int k = 0; k < rows; ++k)
    recording.forces.row(k) << 0.05, 0.02, -0.5 * (1 - std::cos(0.1 * k));
  recording.rest.setConstant(3100);
  TouchPlace place;
  place.x = -6e-3;
  place.angle = 0.5;
  place.radius = 3e-3;
  place.length = 5e-3;
  recording.changes = emulate(recording, normative(), place);
  const Comparison found = compare_press(recording, normative(), false, 0.5, 2400);
  EXPECT_NEAR(found.place.x, place.x, 1.5e-3);
  EXPECT_NEAR(found.place.angle, place.angle, 0.15);
  for (const SignalScore& s : found.signals) EXPECT_LT(s.rms, 5) << s.name;
}

TEST(Compare, EmulationFollowsTheRealFinger) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar");
  const PressRecording recording =
      read_press(support::recordings() / "biotac_foam_bar" / "ring_finger_dev.csv");
  const Comparison found = compare_press(recording, normative(), false, 0.5, 1600);
  const SignalScore& pressure = found.signals.back();
  EXPECT_GT(pressure.correlation, 0.99);
  EXPECT_NEAR(pressure.gain_emulated, pressure.gain_measured, 5);
  double sum = 0, size = 0;
  for (const SignalScore& s : found.signals) {
    sum += s.rms * s.rms;
    size += s.gain_measured * s.gain_measured * 0.45 * 0.45;  // force: 0.45 N RMS
    if (s.gain_measured < 60) continue;                       // electrodes of the pressed side
    EXPECT_GT(s.correlation, 0.99) << s.name;
    EXPECT_LT(s.loop_emulated, 0) << s.name;
  }
  EXPECT_LT(sum, 0.3 * size);
}

}  // namespace
}  // namespace palpate::collect
