#include "tools/fit/experiments/ball.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/unit/tools/fit/fit_folder.hpp"
#include "tools/fit/gradient_check.hpp"

namespace palpate::fit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kRadius = 4e-3, kModulus = 50e3, kPoisson = 0.4, kOffset = 0.2e-3;

double hertz_force(double depth) {
  const double d = std::max(0.0, depth - kOffset);
  return 4.0 / 3 * kModulus / (1 - kPoisson * kPoisson) * std::sqrt(kRadius) * std::pow(d, 1.5);
}

std::string plan(const std::string& columns) {
  return "name: ball\nrecordings:\n  - {kind: hertz, file: a.csv, geometry: {radius: 4 mm}, "
         "poisson_ratio: 0.4, columns: {" +
         columns + "}}\n";
}

constexpr char kScalars[] = "depth: {name: d, unit: mm}, force: {name: F}";

TEST(Hertz, FindsModulusAndOffset) {
  FitFolder folder;
  std::ostringstream out;
  out.precision(12);
  out << "d,F\n";
  for (int i = 0; i < 15; ++i) out << 0.21 * i << ',' << hertz_force(0.21e-3 * i) << '\n';
  folder.write("a.csv", out.str());
  const std::vector<JobResult> results = folder.run(plan(kScalars));
  EXPECT_NEAR(results[0].fit.find("young_modulus")->value / kModulus, 1, 1e-6);
  EXPECT_NEAR(results[0].fit.find("a.contact_offset")->value, kOffset, 1e-9);
  EXPECT_EQ(results[0].fit.find("poisson_ratio")->standing, Standing::kKnown);
  for (const GradientCheck& check :
       check_gradients(*results[0].problem, results[0].fit.solution.coordinates))
    EXPECT_LT(check.difference, kGradientTolerance);
}

/// A probe that moves obliquely into a tilted surface: depth and force are along the normal.
TEST(Hertz, PositionsAndForcesAreTakenAlongTheNormal) {
  FitFolder folder;
  std::ostringstream out;
  out.precision(12);
  out << "cx,cy,cz,nx,ny,nz,x,y,z,fx,fy,fz\n";
  for (int i = 0; i < 15; ++i) {
    const double depth = 0.21 * i, force = hertz_force(1e-3 * depth), aside = 0.05 * i;
    out << "1,2,3,0.6,0,0.8," << 1 - 0.6 * depth + 0.8 * aside << ",2,"
        << 3 - 0.8 * depth - 0.6 * aside << ',' << 0.6 * force << ",0.1," << 0.8 * force << '\n';
  }
  folder.write("a.csv", out.str());
  std::string columns;
  for (const std::string axis : {"x", "y", "z"})
    columns += std::string(columns.empty() ? "" : ", ") + "centre_" + axis + ": {name: c" + axis +
               ", unit: mm}, normal_" + axis + ": {name: n" + axis + "}, position_" + axis +
               ": {name: " + axis + ", unit: mm}, force_" + axis + ": {name: f" + axis + "}";
  const std::vector<JobResult> results = folder.run(plan(columns));
  EXPECT_NEAR(results[0].fit.find("young_modulus")->value / kModulus, 1, 1e-6);
}

TEST(Hertz, BadRecordingsAreRefusedWithRowAndRemedy) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"d,F\n0,0\n", "3 are needed"},
      {"d,F\n1,0\n1,1\n1,2\n", "depth is the same"},
      {"d,F\n0,2\n1,2\n2,2\n", "force is the same"},
      {"d,F\n0,0\n1,-1\n2,-2\n", "a.csv:4: force falls with depth"},
      {"d,F\n0,0\n-1,1\n-2,2\n", "sign: -1"},
      {"d,F\n0,0\n1,\n2,2\n", "a.csv:3:F"},
      {"d,G\n0,0\n1,1\n2,2\n", "no column 'F'"}};
  for (const auto& [csv, complaint] : bad) {
    FitFolder folder;
    folder.write("a.csv", csv);
    EXPECT_THAT(folder.complaint(plan(kScalars)), AllOf(HasSubstr("a.csv"), HasSubstr(complaint)));
  }
}

}  // namespace
}  // namespace palpate::fit
