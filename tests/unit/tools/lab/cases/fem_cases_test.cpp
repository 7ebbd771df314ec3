#include <gtest/gtest.h>

#include "tests/support/recordings.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_score.hpp"

// Every row of `baseline_on_delivered_meshes`: an independent code on the same meshes.
namespace palpate::cases {
namespace {

using mesh::ElementOrder;
using Row = std::tuple<const char*, const char*, ElementOrder>;

class ReferenceCases : public testing::TestWithParam<Row> {};

TEST_P(ReferenceCases, AreSolvedAsTheStoredRowSays) {
  PALPATE_REQUIRE_RECORDING("fem_cases");
  const auto& [name, mesh, order] = GetParam();
  const CaseFile c = read_case(support::recordings() / "fem_cases" / name);
  const bool quadratic = order == ElementOrder::kQuadratic;
  const bool coarse = std::string(mesh) == "coarse";
  const int ticks = coarse ? 20 : 0;  // if it is fast, the loop's model too
  const CaseScore s = score_case(c, mesh, read_case_mesh(c, mesh), order, {ticks, {}});
  ASSERT_TRUE(s.equilibrium.converged);
  ASSERT_NE(s.baseline, nullptr);
  EXPECT_EQ(s.nodes, s.baseline->at("nodes_fem").get<int>());
  EXPECT_EQ(s.baseline->contains("twist_deg"), s.figures.twist_deg.has_value());
  EXPECT_EQ(s.baseline->contains("force"), s.figures.grasp.has_value());

  // Linear elements have a unique result. That of quadratic ones depends on the quadrature, since
  // there is one rotation per point: the baseline has fourteen points, ours four. One probe lies
  // outside the coarse mesh of hetero_bar, and is extrapolated from one of two tetrahedra.
  const BaselineDifference d = compare(s.figures, *s.baseline);
  EXPECT_LT(d.largest_share(), quadratic ? 1e-4 : std::string(name) == "hetero_bar" ? 1e-6 : 1e-8);
  const double share = quadratic ? 1e-4 : 1e-7;
  EXPECT_LT(d.twist.value_or(0), share);
  EXPECT_LT(d.force.value_or(0), share);
  EXPECT_LT(d.moment.value_or(0), share);
  // A face that rotates about its own centre has almost no mean displacement: the cancelling
  // displacements count there.
  if (d.mean) {
    const double length =
        s.figures.twist_deg ? s.figures.largest_reference : s.figures.mean->norm();
    EXPECT_LT(*d.mean * s.figures.mean->norm(), share * length);
  }

  if (s.incremental) {
    EXPECT_LT(s.incremental->deviation, 1e-3 * s.figures.largest_reference);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rows, ReferenceCases,
    testing::Combine(testing::Values("bar_grasp_motion", "bar_tip_1N", "bar_torsion", "beam_nu049",
                                     "hetero_bar", "slender_gravity"),
                     testing::Values("coarse", "mid"),
                     testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic)),
    [](const testing::TestParamInfo<Row>& row) {
      return std::string(std::get<0>(row.param)) + "_" + std::get<1>(row.param) +
             (std::get<2>(row.param) == ElementOrder::kLinear ? "_P1" : "_P2");
    });

}  // namespace
}  // namespace palpate::cases
