#include "tools/lab/cases/case_score.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/lab/cases/case_folder.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_report.hpp"

namespace palpate::cases {
namespace {

using Eigen::Vector3d;
using mesh::ElementOrder;

constexpr double kArea = 0.04 * 0.04;

class PulledBar : public testing::TestWithParam<ElementOrder> {
 protected:
  CaseScore score(const std::string& yaml, const ScoreCaseOptions& options) {
    write_pulled_bar(folder_, yaml);
    case_ = read_case(folder_.path());
    return score_case(case_, "coarse", read_case_mesh(case_, "coarse"), GetParam(), options);
  }

  CaseFolder folder_;
  CaseFile case_;
};

// Uniform stretch is exact for both elements: all figures are exact.
TEST_P(PulledBar, StretchesByForceOverStiffness) {
  ScoreCaseOptions options{100, DynamicOptions()};
  options.dynamic->rise = 0.05;
  const CaseScore s = score(kPulledBar, options);
  ASSERT_TRUE(s.converged());
  const double pull = kPulledStretch * 0.2;
  EXPECT_LT(s.figures.probe_max, 1e-9 * pull);
  EXPECT_LT((*s.figures.mean - Vector3d(pull, 0, 0)).norm(), 1e-9 * pull);
  EXPECT_LT((s.figures.fixed->force - Vector3d(-2, 0, 0)).norm(), 1e-8);
  EXPECT_LT((s.figures.fixed->torque - Vector3d(0, -2 * 0.02, 2 * 0.02)).norm(), 1e-9);
  EXPECT_FALSE(s.figures.grasp || s.figures.twist_deg || s.baseline);

  // The incremental model ends there, and so does the dynamic one, at rest.
  EXPECT_EQ(s.incremental->times.ticks, 100);
  EXPECT_GT(s.incremental->times.p50, 0);
  EXPECT_LE(s.incremental->times.p50, s.incremental->times.p99);
  EXPECT_LT(s.incremental->deviation, 1e-5 * pull);
  EXPECT_LT(s.dynamic_figures->probe_max, 1e-4 * pull);
  EXPECT_GT(s.dynamic->settling_time, 0.02);  // not before the load is complete
  EXPECT_LT(s.dynamic->settling_time, s.dynamic->seconds);
}

TEST_P(PulledBar, AddsUpSeveralLoads) {
  const std::string half_pull = R"(- {group: load, total_force: [-1, 0, 0]}
- {group: load, type: uniform_traction, traction: [312.5, 0, 0]}
- {group: load, formula: '625*(1, 0, 0)'}
)";
  std::string yaml = kPulledBar;
  yaml.insert(yaml.find("files:"), half_pull);  // -1 + 0.5 + 1 N more
  const CaseScore s = score(yaml, {0, {}});
  ASSERT_TRUE(s.converged());
  EXPECT_LT((s.figures.fixed->force - Vector3d(-2.5, 0, 0)).norm(), 1e-8);
  EXPECT_NEAR(s.figures.mean->x(), 1.25 * kPulledStretch * 0.2, 1e-12);
  EXPECT_NEAR(s.figures.max_share(), 0.25, 1e-8);
}

TEST_P(PulledBar, PullsAGraspAsHardAsItsStiffness) {
  const std::string yaml = std::string(kPulledBar, std::string(kPulledBar).find("loads:")) +
                           "grasp:\n  group: load\n  centre: [0.2, 0.02, 0.03]\n"
                           "  translation: [0.0025, 0, 0]\n";
  const CaseScore s = score(yaml, {50, {}});
  ASSERT_TRUE(s.converged());
  const double pull = 1e5 * kArea * kPulledStretch;
  EXPECT_LT((s.figures.grasp->force - Vector3d(pull, 0, 0)).norm(), 1e-8);
  // The resultant acts 10 mm below the centre.
  EXPECT_LT((s.figures.grasp->torque - Vector3d(0, -0.01 * pull, 0)).norm(), 1e-9);
  EXPECT_LT(s.figures.max_share(), 1e-9);

  const nlohmann::json j = to_json(s);
  EXPECT_EQ(j.at("converged"), true);
  EXPECT_NEAR(j.at("grasp_force").at(0).get<double>(), pull, 1e-8);
  EXPECT_LT(j.at("probe_rms_error_over_max_u").get<double>(), 1e-9);
  EXPECT_EQ(j.at("ticks"), 50);
}

TEST_P(PulledBar, IsComparedWithTheStoredRow) {
  const std::string row = GetParam() == ElementOrder::kLinear ? "P1_coarse" : "P2_coarse";
  folder_.write("summary.json", R"({"reference": {"monitored": "twist_deg"},
    "baseline_on_delivered_meshes": {")" +
                                    row + R"(": {"mean": [0.0024, 0, 0],
    "probe_rms_error_over_max_u": 0.1, "probe_max_error_over_max_u": 0.01,
    "mean_error_norm": null}}})");
  const CaseScore s = score(kPulledBar, {0, {}});
  ASSERT_NE(s.baseline, nullptr);
  const BaselineDifference d = compare(s.figures, *s.baseline);
  EXPECT_NEAR(d.rms_share, -0.1, 1e-8);
  EXPECT_NEAR(d.max_share, -0.01, 1e-8);
  EXPECT_NEAR(*d.mean, 1.0 / 24, 1e-6);
  EXPECT_FALSE(d.twist || d.force || d.moment);
  EXPECT_NEAR(d.largest_share(), 0.1, 1e-8);
  EXPECT_NEAR(*s.figures.twist_deg, 0, 1e-8);
  EXPECT_NEAR(to_json(s).at("difference_from_baseline").at("mean_relative").get<double>(), 1.0 / 24,
              1e-6);
}

/// A round bar: a box whose square cross-sections are mapped to circles.
mesh::MeshWithGroups round_bar() {
  mesh::MeshWithGroups bar = bar_mesh({0.2, 0.04, 0.04}, {6, 4, 4});
  for (int n = 0; n < bar.mesh.node_count(); ++n) {
    Eigen::Vector2d q = bar.mesh.nodes.col(n).tail<2>().array() - 0.02;
    const double reach = q.cwiseAbs().maxCoeff();
    if (reach > 0) q *= reach / q.norm();
    bar.mesh.nodes.col(n).tail<2>() = q.array() + 0.02;
  }
  return bar;
}

TEST_P(PulledBar, MayBeRound) {
  std::string yaml = kPulledBar;
  yaml.replace(yaml.find("geometry:"), yaml.find("material:") - yaml.find("geometry:"),
               "geometry: {type: cylinder, radius: 0.02, length: 0.2}\n");
  write_pulled_bar(folder_, yaml);
  folder_.write_mesh("mesh_coarse.msh", round_bar());
  case_ = read_case(folder_.path());
  const CaseScore s =
      score_case(case_, "coarse", read_case_mesh(case_, "coarse"), GetParam(), {0, {}});
  ASSERT_TRUE(s.converged());
  // The full force acts, distributed over the mesh's polygon approximation of the circle.
  EXPECT_LT((s.figures.fixed->force - Vector3d(-2, 0, 0)).norm(), 1e-8);
  EXPECT_NEAR(s.figures.mean->x(), 2 * 0.2 / (1e5 * 8 * 4e-4 * std::sin(M_PI / 8)), 2e-5);
  EXPECT_GT(s.figures.outside, 0);  // probes that ran along the edges of the square
  EXPECT_TRUE(std::isfinite(s.figures.probe_max));
}

INSTANTIATE_TEST_SUITE_P(Orders, PulledBar,
                         testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic));

}  // namespace
}  // namespace palpate::cases
