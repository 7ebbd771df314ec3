#include "tools/lab/cases/case_beam.hpp"

#include <gtest/gtest.h>

#include "tests/support/recordings.hpp"

namespace palpate::cases {
namespace {

const CaseGrid kGrid{{7, 2, 2}, mesh::CellCut::kFive, 2};

TEST(Beam, SagsAsTheoryOfBeamsSaysWhereItIsStiff) {
  const BeamModel model(kGrid);
  const double e = 1e8, length = 0.1, side = 0.03;
  const double inertia = std::pow(side, 4) / 12,
               shear = e / (2 * (1 + 0.499)) * 5 / 6 * side * side;
  const double weight = 1070 * 9.81 * side * side;  // N/m
  const double by_weight =
      weight * std::pow(length, 4) / (8 * e * inertia) + weight * length * length / (2 * shear);
  const MarkerMotion idle = model.predict(e, 0), loaded = model.predict(e, 1);
  // The clamp prevents lateral expansion of the rubber, which makes it about 10 % stiffer than a
  // beam.
  EXPECT_LT(-idle.row(2).mean(), by_weight);
  EXPECT_GT(-idle.row(2).mean(), 0.87 * by_weight);
  const double by_load = std::pow(length, 3) / (3 * e * inertia) + length / shear;
  EXPECT_LT(-(loaded - idle).row(2).mean(), by_load);
  EXPECT_GT(-(loaded - idle).row(2).mean(), 0.87 * by_load);
  // A marker above the axis moves forward with the tip's rotation; one below it backward.
  EXPECT_GT(loaded(0, 0), 0);
  EXPECT_LT(loaded(0, 2), 0);
  // The two at the sides stand 9 mm above and below the axis.
  EXPECT_NEAR(loaded(1, 0), 0, 1e-3 * std::abs(loaded(2, 0)));
}

TEST(Beam, FitFindsTheModulusThatMadeTheData) {
  const BeamModel model({{4, 1, 1}, mesh::CellCut::kFive, 2});
  std::vector<BeamRecording> recordings{{"a", 0, model.predict(2e5, 0)},
                                        {"b", 0.5, model.predict(2e5, 0.5)}};
  const BeamFit fit = fit_beam(model, recordings);
  EXPECT_NEAR(fit.young_modulus, 2e5, 50);
  EXPECT_LT(marker_error(fit.errors[1]), 1e-5);
  // The held-out recording does not affect the fit, but is predicted.
  recordings[1].measured.array() += 0.01;
  const BeamFit without = fit_beam(model, recordings, 1);
  EXPECT_NEAR(without.young_modulus, 2e5, 50);
  EXPECT_NEAR(tip_error(without.errors[1]), 0.01 * std::sqrt(3.0), 1e-4);
}

TEST(Beam, OneModulusBringsTheRecordedTipWithinAMillimetre) {
  PALPATE_REQUIRE_RECORDING("beam_dragonskin/static_deflection.csv");
  const std::vector<BeamRecording> recordings =
      read_beam(support::recordings() / "beam_dragonskin/static_deflection.csv");
  ASSERT_EQ(recordings.size(), 3u);
  const BeamModel model(kGrid);
  const BeamFit fit = fit_beam(model, recordings);
  EXPECT_GT(fit.young_modulus, 240e3);  // others found 252 to 271 kPa
  EXPECT_LT(fit.young_modulus, 280e3);
  for (const MarkerMotion& errors : fit.errors) EXPECT_LT(tip_error(errors), 1e-3);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(marker_error(fit_beam(model, recordings, i).errors[i]), 1.5e-3) << i;
}

}  // namespace
}  // namespace palpate::cases
