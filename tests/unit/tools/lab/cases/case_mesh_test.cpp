#include "tools/lab/cases/case_mesh.hpp"

#include <gtest/gtest.h>

#include <set>

#include "rt/config/node.hpp"
#include "tools/lab/cases/case_sweep.hpp"

namespace palpate::cases {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// An L of two boxes, clamped at x = 0, loaded on a part of its upper face.
CaseFile corner() {
  CaseFile c;
  c.boxes = {{Vector3d(0, 0, 0), Vector3d(0.2, 0.05, 0.05)},
             {Vector3d(0.15, 0, 0.05), Vector3d(0.2, 0.05, 0.15)}};
  c.fixed = CaseRegion{"fixed", {Vector3d(0, 0, 0), Vector3d(0, 0.05, 0.05)}};
  CaseLoad load;
  load.region = {"load", {Vector3d(0.15, 0.01, 0.15), Vector3d(0.2, 0.04, 0.15)}};
  load.total_force = Vector3d(1, 0, 0);
  c.loads = {load};
  return c;
}

double area(const mesh::MeshWithGroups& m, const std::string& group) {
  double total = 0;
  const Eigen::Matrix3Xi& triangles = m.groups.at(group).triangles;
  for (int t = 0; t < triangles.cols(); ++t) {
    const Vector3d a = m.mesh.nodes.col(triangles(0, t));
    const Vector3d b = m.mesh.nodes.col(triangles(1, t)), c = m.mesh.nodes.col(triangles(2, t));
    total += 0.5 * (b - a).cross(c - a).norm();
  }
  return total;
}

std::set<double> planes(const mesh::MeshWithGroups& m, int axis) {
  std::set<double> all;
  for (int n = 0; n < m.mesh.node_count(); ++n) all.insert(m.mesh.nodes(axis, n));
  return all;
}

TEST(CaseMesh, FillsAUnionOfBoxesAndItsRegions) {
  const mesh::MeshWithGroups m = make_case_mesh(corner(), {{8, 1, 6}});
  double volume = 0;
  for (int t = 0; t < m.mesh.tetrahedron_count(); ++t) volume += mesh::volume(m.mesh, t);
  EXPECT_NEAR(volume, 0.2 * 0.05 * 0.05 + 0.05 * 0.05 * 0.1, 1e-15);
  EXPECT_NEAR(area(m, "fixed"), 0.05 * 0.05, 1e-15);
  EXPECT_NEAR(area(m, "load"), 0.05 * 0.03, 1e-15);  // a part of a face: planes at its edges
  EXPECT_EQ(planes(m, 0).size(), 9u);
  EXPECT_EQ(planes(m, 1).size(), 4u);  // more than requested
  EXPECT_EQ(planes(m, 0).count(0.15), 1u);
}

TEST(CaseMesh, GetsFinerTowardsTheClampWhereGraded) {
  const CaseGrid grid{{8, 1, 6}, mesh::CellCut::kSix, 2};
  EXPECT_EQ(grid.text(), "8x1x6k^2.0");
  const std::set<double> all = planes(make_case_mesh(corner(), grid), 0);
  const std::vector<double> x(all.begin(), all.end());
  ASSERT_EQ(x.size(), 9u);
  for (std::size_t i = 2; x[i] < 0.149; ++i) EXPECT_GT(x[i] - x[i - 1], x[i - 1] - x[i - 2]) << i;
  EXPECT_DOUBLE_EQ(x.back(), 0.2);

  // The same clamp on the other side.
  CaseFile c = corner();
  c.fixed->box = {Vector3d(0.2, 0, 0), Vector3d(0.2, 0.05, 0.05)};
  const std::set<double> mirrored = planes(make_case_mesh(c, grid), 0);
  EXPECT_LT(*mirrored.rbegin() - *std::next(mirrored.rbegin()), 0.01);
}

TEST(CaseMesh, SaysWhatIsMissing) {
  CaseFile c = corner();
  c.loads[0].region.box = {};
  EXPECT_THROW(make_case_mesh(c, {}), config::Error);
  c = corner();
  c.boxes.clear();
  EXPECT_THROW(make_case_mesh(c, {}), config::Error);
}

TEST(Sweep, LadderGrowsWithinItsLimit) {
  CaseFile c = corner();
  c.boxes.pop_back();
  for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const std::vector<CaseGrid> grids = grid_ladder(c, order, 700);
    ASSERT_GT(grids.size(), 5u);
    int largest = 0;
    for (const CaseGrid& grid : grids) {
      const int nodes =
          mesh::make_element_mesh(mesh::make_box({1, 1, 1}, grid.cells), order).node_count();
      EXPECT_LE(nodes, 700);
      largest = std::max(largest, nodes);
    }
    EXPECT_GT(largest, 350);
  }
}

CaseScore scored(int nodes, double rms, double p50, mesh::ElementOrder order) {
  CaseScore s;
  s.order = order;
  s.nodes = nodes;
  s.figures.largest_reference = 1;
  s.figures.probe_rms = rms;
  s.equilibrium.converged = true;
  s.incremental.emplace();
  s.incremental->converged = true;
  s.incremental->times.p50 = p50;
  return s;
}

TEST(Sweep, PicksTheSmallestMeshWithinTheGoalAndTheFront) {
  const auto linear = mesh::ElementOrder::kLinear, quadratic = mesh::ElementOrder::kQuadratic;
  std::vector<CaseScore> scores = {
      scored(100, 0.03, 10, quadratic),  scored(200, 0.015, 20, quadratic),
      scored(300, 0.018, 30, quadratic), scored(500, 0.01, 40, quadratic),
      scored(700, 0.001, 50, quadratic), scored(50, 0.001, 5, linear)};
  EXPECT_EQ(smallest_within_goal(scores, {})->nodes, 200);
  EXPECT_EQ(most_accurate(scores, {})->nodes, 500);
  std::vector<int> front;
  for (const CaseScore* s : best_of(scores, quadratic)) front.push_back(s->nodes);
  EXPECT_EQ(front, (std::vector<int>{100, 200, 500, 700}));

  const common::Plot plot = error_against_time("bar", scores);
  ASSERT_EQ(plot.curves.size(), 2u);
  EXPECT_EQ(plot.curves[1].x, (std::vector<double>{10, 20, 40, 50}));
  EXPECT_NEAR(plot.curves[1].y[1], 1.5, 1e-12);

  scores[1].equilibrium.converged = false;
  EXPECT_EQ(smallest_within_goal(scores, {})->nodes, 300);
  scores.resize(1);
  EXPECT_EQ(smallest_within_goal(scores, {}), nullptr);
}

}  // namespace
}  // namespace palpate::cases
