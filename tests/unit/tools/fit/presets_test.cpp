#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <thread>

#include "tests/support/recordings.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {
namespace {

struct Preset {
  Plan plan;
  std::vector<JobResult> results;
};

Preset run_preset(const std::string& name, const std::vector<std::string>& overrides = {}) {
  Preset preset;
  RunOptions options;
  options.data = support::recordings();
  options.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 4U));
  const std::string file = std::string(PALPATE_SOURCE_DIR) + "/tools/fit/presets/" + name + ".yaml";
  preset.plan = read_plan(config::Node::load_file(file, overrides), options.data);
  preset.results = run(preset.plan, options);
  return preset;
}

double median(std::vector<double> values) {
  EXPECT_FALSE(values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? std::nan("") : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

/// Of the first series of each fit of a variant.
template <class Figure>
std::vector<double> figures(const Preset& preset, const std::string& variant,
                            const Figure& figure) {
  std::vector<double> values;
  for (std::size_t k = 0; k < preset.results.size(); ++k)
    if (preset.plan.jobs[k].variant == variant && preset.results[k].error.empty())
      values.push_back(figure(preset.results[k]));
  return values;
}

TEST(Presets, ElastomersAreFittedAndPredicted) {
  PALPATE_REQUIRE_RECORDING("elastomer_tensile");
  const Preset preset = run_preset("elastomer_tensile");
  const auto fitted = [](const JobResult& r) { return r.fit.series.front().fitted.percent; };
  const auto predicted = [](const JobResult& r) { return r.fit.series.front().held_out.percent; };
  ASSERT_EQ(figures(preset, "Mooney-Rivlin", fitted).size(), 12U);
  EXPECT_LT(median(figures(preset, "Mooney-Rivlin", fitted)), 1.2);
  EXPECT_LT(median(figures(preset, "Ogden, 1 term", fitted)), 1.1);
  EXPECT_LT(median(figures(preset, "Mooney-Rivlin, to 50 %", predicted)), 4.0);
  // All estimates of the secant agree, within their intervals of its spread.
  const auto modulus = [](const JobResult& r) { return r.effective->young_modulus; };
  const std::vector<double> one = figures(preset, "Mooney-Rivlin", modulus),
                            other = figures(preset, "Ogden, 1 term", modulus);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i] / other[i], 1, 0.01);
}

TEST(Presets, IndentationsArePredictedAtGreaterDepths) {
  PALPATE_REQUIRE_RECORDING("robot_palpation");
  const Preset preset = run_preset("robot_palpation");
  // Attainable error, mN: medians over all locations and depths 6 to 9.
  const std::map<std::string, double> attainable = {{"meat0904_region4", 22.0},
                                                    {"pig_liver_20150826_region1", 24.5},
                                                    {"probingRAL2018_T1", 76.0},
                                                    {"probingRAL2018B_T1", 86.0}};
  for (const auto& [group, limit] : attainable) {
    std::vector<double> errors;
    for (std::size_t k = 0; k < preset.results.size(); ++k) {
      const Job& job = preset.plan.jobs[k];
      const JobResult& result = preset.results[k];
      if (job.group != group || job.variant != "Hertz with offset, depths 0 to 5") continue;
      if (!result.error.empty()) continue;
      const Series& series = result.problem->series_at(0);
      for (Eigen::Index i = 6; i < series.measured.size(); ++i)
        errors.push_back(1e3 * std::abs(result.fit.series[0].predicted[i] - series.measured[i]));
    }
    EXPECT_LE(median(errors), limit) << group;
  }
}

TEST(Presets, FoamsHaveTheModuliThatWereMeasured) {
  PALPATE_REQUIRE_RECORDING("foam_mech");
  const Preset preset = run_preset("foam_mech", {"solver.profile=never"});
  std::map<std::string, std::vector<double>> moduli, ratios;
  for (std::size_t k = 0; k < preset.results.size(); ++k) {
    const Job& job = preset.plan.jobs[k];
    const JobResult& result = preset.results[k];
    ASSERT_EQ(result.error, "") << job.title();
    if (job.variant == "measurers' procedure") {
      ASSERT_TRUE(result.effective) << job.title();
      moduli[job.group].push_back(result.effective->young_modulus);
      ratios[job.group].push_back(result.effective->poisson_ratio);
    } else if (job.variant.rfind("mean curve", 0) == 0) {
      EXPECT_LT(result.fit.series.front().fitted.percent, 1) << job.title();
    } else {
      EXPECT_LT(result.fit.series.front().fitted.percent, 1.5) << job.title();
    }
  }
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v / static_cast<double>(values.size());
    return sum;
  };
  // By the same procedure on these specimens; the spread between specimens is 5 to 25 %.
  EXPECT_NEAR(mean(moduli["new-heel, compression"]) / 332e3, 1, 0.05);
  EXPECT_NEAR(mean(moduli["new-mid, compression"]) / 348e3, 1, 0.05);
  EXPECT_NEAR(mean(moduli["new-toe, compression"]) / 203e3, 1, 0.05);
  EXPECT_NEAR(mean(moduli["leap, tension"]) / 623e3, 1, 0.1);
  for (const char* foam : {"new-heel", "new-mid", "new-toe"}) {
    EXPECT_GT(mean(ratios[std::string(foam) + ", compression"]), 0.05);
    EXPECT_LT(mean(ratios[std::string(foam) + ", compression"]), 0.17);
    EXPECT_GT(mean(ratios[std::string(foam) + ", tension"]), 0.15);
    EXPECT_LT(mean(ratios[std::string(foam) + ", tension"]), 0.48);
  }
}

}  // namespace
}  // namespace palpate::fit
