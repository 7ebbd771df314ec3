#include "tools/fit/experiments/effective.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/math/random.hpp"
#include "core/solid/strain_energy.hpp"
#include "tests/unit/tools/fit/fit_folder.hpp"

namespace palpate::fit {
namespace {

/// Stress and width of a Neo-Hookean bar (E 40 kPa) up to `strain`; noise of 1 % of the maximum.
std::vector<JobResult> fit_bar(double nu, double strain, const std::string& more, int seed) {
  FitFolder folder;
  const auto material = solid::StrainEnergy::make("neo_hookean");
  math::Random random(static_cast<std::uint64_t>(seed), "bar");
  std::ostringstream out;
  out.precision(12);
  out << "e,s,w\n";
  for (int i = 0; i <= 60; ++i) {
    const double e = strain * i / 60;
    solid::UniaxialStress r;
    EXPECT_TRUE(respond_uniaxially(*material, Eigen::Vector2d(40e3, nu), 1 + e, r));
    out << e << ',' << r.stress + 400 * strain * random.normal() << ','
        << 0.02 * r.lateral + 1e-6 * random.normal() << '\n';
  }
  folder.write("a.csv", out.str());
  return folder.run(
      "name: bar\nrecordings:\n  - {kind: uniaxial, file: a.csv, columns: {strain: {name: e}, "
      "stress: {name: s}, width: {name: w}}, model: neo_hookean" +
      more + "}\n");
}

TEST(Effective, OfSmallStrainsIsTheMaterialItself) {
  const std::vector<JobResult> results = fit_bar(0.3, 0.02, ", poisson_ratio: free", 1);
  ASSERT_TRUE(results[0].effective);
  const EffectiveMaterial& e = *results[0].effective;
  EXPECT_NEAR(e.young_modulus / results[0].fit.find("young_modulus")->value, 1, 0.02);
  EXPECT_NEAR(e.poisson_ratio, 0.3, 0.02);
  EXPECT_LT(e.modulus_interval[0], e.young_modulus);
  EXPECT_GT(e.modulus_interval[1], e.young_modulus);
  EXPECT_NEAR(e.strain_range[1], 0.02, 1e-12);
}

TEST(Effective, OfGreatStrainsIsTheSecantOfTheCurve) {
  const std::vector<JobResult> results = fit_bar(0.5, 1, ", poisson_ratio: 0.5", 2);
  ASSERT_TRUE(results[0].effective);
  // Least squares through the origin of mu (l - l^-2).
  double squares = 0, products = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double e = i / 1000.0, l = 1 + e;
    squares += e * e;
    products += e * 40e3 / 3 * (l - 1 / (l * l));
  }
  EXPECT_NEAR(results[0].effective->young_modulus / (products / squares), 1, 0.02);
  EXPECT_DOUBLE_EQ(results[0].effective->poisson_ratio, kGreatestEffectivePoisson);
}

TEST(Effective, IntervalsCoverTheSecant) {
  double truth = 0;
  {
    double squares = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double e = 0.5 * i / 1000, l = 1 + e;
      squares += e * e;
      truth += e * 40e3 / 3 * (l - 1 / (l * l));
    }
    truth /= squares;
  }
  int covered = 0;
  constexpr int kSeeds = 60;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto interval =
        fit_bar(0.5, 0.5, ", poisson_ratio: 0.5", seed)[0].effective->modulus_interval;
    covered += interval[0] <= truth && truth <= interval[1] ? 1 : 0;
  }
  EXPECT_GE(covered, 51);
}

}  // namespace
}  // namespace palpate::fit
