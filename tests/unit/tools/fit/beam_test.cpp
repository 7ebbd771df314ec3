#include "tools/fit/experiments/beam.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/recordings.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/fit/gradient.hpp"
#include "tools/fit/experiments/beam_model.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector3d;

BeamShape slender() {
  BeamShape shape;
  shape.corner = {-0.1, 0, 0};
  shape.size = {0.1, 0.01, 0.01};
  shape.cells = {8, 2, 2};
  shape.markers = {{0, 0.005, 0.016}};
  shape.clamp_markers = {{-0.1, 0.02, 0.005}};
  return shape;
}

BeamVector stiff() {
  BeamVector p = BeamVector::Zero();
  p[kYoung] = 5e7;
  p[kPoisson] = 0.45;
  p[kDensity] = 1000;
  p[kStiffnessDamping] = 1e-4;
  return p;
}

TEST(BeamModel, SagsAsEulerAndBernoulliHaveIt) {
  BeamShape shape = slender();
  shape.tip_mass = 0.002;
  const BeamModel model(shape);
  const BeamVector p = stiff();
  BeamPrediction rest;
  ASSERT_TRUE(model.at_rest(p, rest));
  const double stiffness = p[kYoung] * std::pow(0.01, 4) / 12, L = 0.1, g = 9.81;
  const double own = p[kDensity] * g * 1e-4 * std::pow(L, 4) / (8 * stiffness);
  const double hung = shape.tip_mass * g * std::pow(L, 3) / (3 * stiffness);
  EXPECT_NEAR(rest.values[2], -(own + hung), 0.03 * (own + hung));
  // 11 mm above the axis the marker moves forward by the rotation of the end.
  const double turn = own * 4 / (3 * L) + hung * 3 / (2 * L);
  EXPECT_NEAR(rest.values[0], 0.011 * turn, 0.03 * 0.011 * turn);
  EXPECT_EQ(rest.values.tail<3>().norm(), 0);
}

TEST(BeamModel, TiltAndOffsetOfTheClampMoveWhatIsOnIt) {
  const BeamModel model(slender());
  BeamVector p = stiff();
  BeamPrediction level, tilted;
  ASSERT_TRUE(model.at_rest(p, level));
  p[kTilt + 1] = 0.02;
  p[kOffset + 2] = 1e-3;
  ASSERT_TRUE(model.at_rest(p, tilted));
  EXPECT_NEAR(tilted.values[2] - level.values[2], 1e-3 - 0.02 * 0.1, 3e-5);
  EXPECT_NEAR(tilted.values[5], 1e-3, 1e-9);
}

/// A released beam overshoots to twice its sag, with the Euler-Bernoulli period.
TEST(BeamModel, SwingsAboutItsRest) {
  const BeamModel model(slender());
  BeamVector p = stiff();
  p[kRelease] = 0.01;
  BeamPrediction rest, swing;
  const double omega = std::pow(18.751, 2) * std::sqrt(p[kYoung] * 1e-4 / 12 / p[kDensity]);
  const double half = M_PI / omega;
  Eigen::VectorXd times(3);
  times << 0, p[kRelease], p[kRelease] + half;
  ASSERT_TRUE(model.at_rest(p, rest));
  ASSERT_TRUE(model.swing(p, times, half / 40, swing));
  EXPECT_NEAR(swing.values[0], 0, 1e-12);
  EXPECT_NEAR(swing.values[1], 0, 1e-12);
  EXPECT_NEAR(swing.values[2] / rest.values[2], 2, 0.1);
}

class BeamRecording : public ::testing::Test {
 protected:
  /// A beam that sags immediately, as a file; its values do not affect the derivatives.
  config::Node node(const std::string& more = "") {
    std::ofstream file(folder_.path() / "beam.csv");
    file << "t,x,y,z,cx,cy,cz\n";
    for (int i = -5; i < 60; ++i)
      file << 0.01 * i << ",0,5," << (i < 0 ? 16 : 12 - 0.01 * i) << ",0,0,0\n";
    file.close();
    return config::Node::from_text(R"(
kind: beam
name: soft
file: beam.csv
columns:
  time: {name: t, unit: s}
  tip_x: {name: x, unit: mm}
  tip_y: {name: y, unit: mm}
  tip_z: {name: z, unit: mm}
  base_x: {name: cx, unit: mm}
  base_y: {name: cy, unit: mm}
  base_z: {name: cz, unit: mm}
tip_load: 0.02 N
geometry: {corner: [-0.1, 0, 0], size: [0.1, 0.01, 0.01], cells: [4, 1, 1]}
markers: [{name: tip, at: [0, 0.005, 0.016]}]
clamp_markers: [{name: base, at: [-0.1, 0.02, 0.005]}]
density: 1000
clamp: free
held_until: -0.005 s
rest_from: 0.5 s
swing: {from: 0, to: 0.08 s, step: 5 ms}
)" + more);
  }
  support::ScratchFolder folder_;
};

TEST_F(BeamRecording, DerivativesMatchDifferences) {
  const auto beam = make_beam(node(), folder_.path());
  Eigen::VectorXd at(kBeamParameters), steps(kBeamParameters);
  at << 4e5, 0.47, 1000, 1, 2e-3, 0.02, -0.03, 0.01, 1e-4, 2e-4, -1e-4, 0.0123, 0.3;
  steps << 400, 1e-4, 1, 0.1, 2e-5, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 2e-5, 1e-3;
  const Eigen::VectorXd errors = gradient_errors(*beam, at, steps);
  for (int p = 0; p < kBeamParameters; ++p) {
    EXPECT_LT(errors[p], 1e-6) << beam->parameters()[p].name;
  }
}

TEST_F(BeamRecording, SaysWhatIsWrongWithIt) {
  EXPECT_THROW(make_beam(node("poisson_ratio: {from: 0.5}\n"), folder_.path()), config::Error);
  EXPECT_THROW(make_beam(node("deviations: {rest: 0 mm}\n"), folder_.path()), config::Error);
}

}  // namespace
}  // namespace palpate::fit
