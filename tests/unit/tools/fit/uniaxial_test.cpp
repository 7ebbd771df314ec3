#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "core/math/random.hpp"
#include "core/solid/strain_energy.hpp"
#include "tests/unit/tools/fit/fit_folder.hpp"
#include "tools/fit/experiments/uniaxial.hpp"
#include "tools/fit/gradient_check.hpp"

namespace palpate::fit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kLength = 0.02, kArea = 1e-4, kModulus = 4e4;

/// Time, displacement and force of a hyperelastic bar in triangular cycles, in mm and N; with
/// width.
std::string cycles_csv(const std::string& model, const Eigen::VectorXd& constants, double sign,
                       double noise, int seed) {
  const auto material = solid::StrainEnergy::make(model);
  math::Random random(static_cast<std::uint64_t>(seed));
  std::ostringstream out;
  out.precision(12);
  out << "t,u,F,w\n";
  constexpr int kSamples = 240, kPerCycle = 80;
  for (int i = 0; i < kSamples; ++i) {
    const double phase = (i % kPerCycle) / static_cast<double>(kPerCycle);
    const double strain = 0.3 * (phase < 0.5 ? 2 * phase : 2 - 2 * phase);
    solid::UniaxialStress r;
    EXPECT_TRUE(respond_uniaxially(*material, constants, 1 + sign * strain, r));
    out << 0.02 * i << ',' << 1e3 * kLength * strain << ','
        << sign * kArea * r.stress + noise * random.normal() << ',' << 10 * r.lateral << '\n';
  }
  return out.str();
}

std::string plan(const std::string& more) {
  return "name: bar\nrecordings:\n  - {kind: uniaxial, file: a.csv, columns: {time: {name: t}, "
         "displacement: {name: u, unit: mm}, force: {name: F}}, geometry: {length: 20 mm, area: "
         "100 "
         "mm2}, " +
         more + "}\n";
}

Eigen::VectorXd constants_of(const std::string& model, double nu) {
  const auto material = solid::StrainEnergy::make(model);
  Eigen::VectorXd c(material->constants().size());
  for (std::size_t i = 0; i < material->constants().size(); ++i)
    c[static_cast<Eigen::Index>(i)] = material->constants()[i].start;
  c[0] = kModulus;
  c[1] = nu;
  return c;
}

TEST(Uniaxial, EveryModelFindsWhatMadeTheData) {
  for (const std::string& model : solid::StrainEnergy::names()) {
    for (const bool is_compression : {false, true}) {
      FitFolder folder;
      const Eigen::VectorXd truth = constants_of(model, 0.3);
      folder.write("a.csv", cycles_csv(model, truth, is_compression ? -1 : 1, 0, 1));
      std::string yaml = plan("model: " + model + ", poisson_ratio: free, direction: " +
                              (is_compression ? "compression" : "tension"));
      yaml.replace(yaml.find("force: {name: F}"), 16,
                   "force: {name: F}, width: {name: w, unit: mm}");
      const std::vector<JobResult> results = folder.run(yaml);
      const Fit& fit = results.front().fit;
      EXPECT_NEAR(fit.find("young_modulus")->value / kModulus, 1, 1e-3) << model;
      EXPECT_NEAR(fit.find("poisson_ratio")->value, 0.3, 1e-3) << model;
      EXPECT_NEAR(fit.find("a.rest_width")->value, 0.01, 1e-5) << model;
      EXPECT_LT(fit.series.front().fitted.percent, 1e-3) << model;
    }
  }
}

TEST(Uniaxial, DerivativesAreRightOfEveryModelAndHistory) {
  for (const std::string& model : solid::StrainEnergy::names()) {
    for (const char* more : {"", ", viscosity: free, relaxation: free", ", contact_offset: free"}) {
      FitFolder folder;
      folder.write("a.csv", cycles_csv(model, constants_of(model, 0.2), -1, 0.01, 2));
      std::string yaml =
          plan("model: " + model +
               ", poisson_ratio: free, load_bias: free, direction: compression" + more);
      yaml.replace(yaml.find("force: {name: F}"), 16,
                   "force: {name: F}, width: {name: w, unit: mm}");
      const auto problem = make_problem(folder.plan(yaml).jobs.front(), folder.path());
      Eigen::VectorXd x = problem->start();
      for (Eigen::Index i = 0; i < x.size(); ++i)
        x[i] = std::clamp(x[i] + 0.03, problem->lower()[i], problem->upper()[i]);
      const std::vector<GradientCheck> checks = check_gradients(*problem, x);
      ASSERT_EQ(checks.size(), 2U) << model;
      for (const GradientCheck& check : checks)
        EXPECT_LT(check.difference, kGradientTolerance)
            << model << more << ": " << check.quantity << " by " << check.parameter;
    }
  }
}

TEST(Uniaxial, OffsetsAreFound) {
  FitFolder folder;
  std::ostringstream out;
  out << "u,F\n";
  for (int i = 0; i <= 100; ++i) {
    const double u = 0.05 * i, pressed = std::max(0.0, u - 0.8) * 1e-3;
    out << u << ',' << 0.3 + kArea * kModulus * pressed / kLength << '\n';
  }
  folder.write("a.csv", out.str());
  std::string yaml =
      plan("model: linear, direction: compression, contact_offset: free, load_bias: free");
  yaml.replace(yaml.find("time: {name: t}, "), 17, "");
  const std::vector<JobResult> results = folder.run(yaml);
  EXPECT_NEAR(results[0].fit.find("a.contact_offset")->value, 0.8e-3, 1e-6);
  EXPECT_NEAR(results[0].fit.find("a.load_bias")->value, 0.3, 1e-4);
  EXPECT_NEAR(results[0].fit.find("young_modulus")->value / kModulus, 1, 1e-4);
}

TEST(Uniaxial, BiasAndOffsetOfALinearBarAreNotBothDetermined) {
  FitFolder folder;
  folder.write("a.csv", cycles_csv("linear", constants_of("linear", 0.3), 1, 0.01, 3));
  const std::vector<JobResult> results =
      folder.run(plan("model: linear, direction: tension, clamp_offset: free, load_bias: free"));
  const Fit& fit = results[0].fit;
  EXPECT_EQ(fit.find("a.clamp_offset")->standing, Standing::kUndetermined);
  EXPECT_EQ(fit.find("a.load_bias")->standing, Standing::kUndetermined);
  EXPECT_EQ(fit.find("young_modulus")->standing, Standing::kEstimated);
  ASSERT_EQ(fit.uncertainty.open.size(), 1U);
  EXPECT_EQ(fit.uncertainty.open[0].shares.size(), 2U);
}

TEST(Uniaxial, ARelaxingBarIsAStandardLinearSolid) {
  // A step that is held: q = g P exp(-t / tau).
  constexpr int kSamples = 50;
  StressHistory elastic{Eigen::VectorXd::Constant(kSamples, 7.0),
                        Eigen::MatrixXd::Zero(kSamples, 2)};
  elastic.stress[0] = 0;
  Eigen::VectorXd time(kSamples);
  for (int i = 0; i < kSamples; ++i) time[i] = i == 0 ? 0 : 1e-9 + 0.1 * (i - 1);
  const StressHistory q = relaxing_part(elastic, time, 0.4, 1.3, 0, 1);
  for (int i = 1; i < kSamples; ++i)
    EXPECT_NEAR(q.stress[i], 0.4 * 7 * std::exp(-time[i] / 1.3), 1e-7);

  // The same recovered from a ramp that is held.
  FitFolder folder;
  std::ostringstream out;
  out << "t,u,F\n";
  out.precision(12);
  const double rate = 0.1, end = 2, g = 0.5, tau = 0.7;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.05 * i, ramp = std::min(t, end);
    // q of a ramp: g E rate tau (1 - exp(-t / tau)), decaying while held.
    const double overstress =
        g * kModulus * rate * tau * (1 - std::exp(-ramp / tau)) * std::exp(-(t - ramp) / tau);
    out << t << ',' << 1e3 * kLength * rate * ramp << ','
        << kArea * (kModulus * rate * ramp + overstress) << '\n';
  }
  folder.write("a.csv", out.str());
  const std::vector<JobResult> results =
      folder.run(plan("model: linear, direction: tension, relaxation: free"));
  EXPECT_NEAR(results[0].fit.find("young_modulus")->value / kModulus, 1, 1e-4);
  EXPECT_NEAR(results[0].fit.find("relaxation_ratio")->value, g, 1e-4);
  EXPECT_NEAR(results[0].fit.find("relaxation_time")->value, tau, 1e-4);
}

TEST(Uniaxial, ViscosityIsFoundTogetherWithTheModulus) {
  FitFolder folder;
  std::ostringstream out;
  out.precision(12);
  out << "t,u,F\n0,0,0\n";
  for (int i = 1; i <= 300; ++i) {
    const double t = 0.01 * i, before = t - 0.01;
    const double strain = 0.05 * (1 - std::cos(3 * t));
    const double rate = (strain - 0.05 * (1 - std::cos(3 * before))) / 0.01;
    out << t << ',' << 1e3 * kLength * strain << ',' << kArea * (kModulus * strain + 900 * rate)
        << '\n';
  }
  folder.write("a.csv", out.str());
  const std::vector<JobResult> results =
      folder.run(plan("model: linear, direction: tension, viscosity: free"));
  EXPECT_NEAR(results[0].fit.find("viscosity")->value, 900, 0.1);
  EXPECT_NEAR(results[0].fit.find("young_modulus")->value / kModulus, 1, 1e-5);
}

TEST(Uniaxial, BadRecordingsAreRefusedWithFileRowAndRemedy) {
  FitFolder folder;
  const std::string tension = plan("model: linear, direction: tension");
  const auto complaint = [&](const std::string& csv) {
    folder.write("a.csv", csv);
    std::filesystem::last_write_time(
        folder.path() / "a.csv",
        std::filesystem::file_time_type::clock::now() + std::chrono::seconds(csv.size()));
    return folder.complaint(tension);
  };
  EXPECT_THAT(complaint("t,u,F\n0,0,0\n"), AllOf(HasSubstr("a.csv:2"), HasSubstr("only 1 sample")));
  EXPECT_THAT(complaint("t,u,F\n0,1,0\n1,1,1\n2,1,2\n3,1,3\n4,1,3.5\n"),
              AllOf(HasSubstr("a.csv:2"), HasSubstr("strain is the same")));
  EXPECT_THAT(complaint("t,u,F\n0,0,1\n1,1,1\n2,2,1\n3,3,1\n4,3.5,1\n"),
              AllOf(HasSubstr("a.csv:2"), HasSubstr("force is the same")));
  EXPECT_THAT(complaint("t,u,F\n0,0,0\n1,1,-1\n2,2,-2\n3,3,-3\n4,4,-4\n"),
              AllOf(HasSubstr("a.csv:6"), HasSubstr("sign: -1")));
  EXPECT_THAT(complaint("t,u,F\n0,0,0\n1,-1,-1\n2,-2,-2\n3,-3,-3\n4,-4.5,-4\n"),
              AllOf(HasSubstr("a.csv:6"), HasSubstr("direction: tension")));
  EXPECT_THAT(complaint("t,u,F\n0,0,0\n1,1,1\n1,2,2\n3,3,3\n4,4,4.25\n"),
              AllOf(HasSubstr("a.csv:4"), HasSubstr("time")));
  EXPECT_THAT(complaint("t,u,F\n0,0,0\n1,1,nan\n2,2,2\n3,3,3\n"),
              AllOf(HasSubstr("a.csv:3:F"), HasSubstr("not a finite number")));
  EXPECT_EQ(complaint("t,u,F\n0,0,0\n1,1,1\n2,2,2.1\n3,3,3.1234\n"), "");

  folder.write("a.csv", "u,F\n0,0\n1,1\n2,2\n1,1\n0,0\n");
  std::string without_time = tension;
  without_time.replace(without_time.find("time: {name: t}, "), 17, "");
  std::filesystem::last_write_time(
      folder.path() / "a.csv",
      std::filesystem::file_time_type::clock::now() + std::chrono::seconds(999));
  EXPECT_THAT(folder.complaint(without_time), AllOf(HasSubstr("a.csv:5"), HasSubstr("comes back")));
}

TEST(Uniaxial, KeysThatContradictAreRefused) {
  FitFolder folder;
  folder.write("a.csv", cycles_csv("linear", constants_of("linear", 0.3), 1, 0.01, 3));
  EXPECT_THAT(folder.complaint(plan("model: linear, poisson_ratio: free")), HasSubstr("width"));
  EXPECT_THAT(folder.complaint(plan("model: linear, contact_offset: free")),
              HasSubstr("clamp_offset"));
  EXPECT_THAT(folder.complaint(plan("model: rubber")), HasSubstr("mooney_rivlin"));
  EXPECT_THAT(folder.complaint(plan("model: linear, colour: red")), HasSubstr("colour"));
  EXPECT_THAT(folder.complaint(plan("model: linear, cycles: {average: true}, relaxation: free")),
              HasSubstr("averaged"));
  EXPECT_THAT(folder.complaint(plan("model: linear, cycles: {skip: 9}")), HasSubstr("cycles.skip"));
}

}  // namespace
}  // namespace palpate::fit
