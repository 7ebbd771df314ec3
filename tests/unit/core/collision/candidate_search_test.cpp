#include "core/collision/candidate_search.hpp"

#include <gtest/gtest.h>

#include "core/collision/surface_samples.hpp"
#include "core/math/random.hpp"
#include "core/mesh/element_mesh.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

const mesh::ElementMesh& bar() {
  static const mesh::ElementMesh mesh = mesh::make_element_mesh(
      mesh::make_box({0.2, 0.05, 0.05}, {8, 2, 2}), mesh::ElementOrder::kQuadratic);
  return mesh;
}

/// A quadratic field, which the shape functions reproduce on flat faces.
double field(const Vector3d& p) { return 1 + p.x() * p.y() + p.z() * p.z() - p.x(); }

void expect_interpolation(const std::vector<mesh::PointWeights>& samples) {
  for (const mesh::PointWeights& sample : samples) {
    double value = 0;
    for (int i = 0; i < sample.count; ++i)
      value += sample.weights[i] * field(bar().nodes.col(sample.nodes[i]));
    EXPECT_NEAR(value, field(sample.interpolate(bar().nodes)), 1e-13);
  }
}

TEST(SurfaceSamples, OfAPlaneAreTheNodesAndTheCentresOfCurvedFaces) {
  const mesh::Surface surface = mesh::extract_surface(bar());
  const double infinite = sample_spacing({"plane", HalfSpace{}, math::Pose::Identity(), 0.5});
  const auto samples = surface_samples(surface, bar().nodes, infinite);
  EXPECT_EQ(samples.size(), surface.nodes.size() + surface.triangle_nodes.size());
  expect_interpolation(samples);
  const mesh::ElementMesh linear = mesh::make_element_mesh(
      mesh::make_box({0.2, 0.05, 0.05}, {8, 2, 2}), mesh::ElementOrder::kLinear);
  const mesh::Surface flat = mesh::extract_surface(linear);
  EXPECT_EQ(surface_samples(flat, linear.nodes, infinite).size(), flat.nodes.size());
}

TEST(SurfaceSamples, ALatticeLeavesNoGapAndRepeatsNoPoint) {
  const mesh::Surface surface = mesh::extract_surface(bar());
  const double spacing = 0.007;
  const auto samples = surface_samples(surface, bar().nodes, spacing);
  expect_interpolation(samples);
  std::vector<Vector3d> places;
  for (const mesh::PointWeights& sample : samples)
    places.push_back(sample.interpolate(bar().nodes));
  for (std::size_t a = 0; a < places.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT((places[a] - places[b]).norm(), 1e-6);
  }
  math::Random random(7);
  for (int k = 0; k < 500; ++k) {
    Vector3d p(random.uniform(0, 0.2), random.uniform(0, 0.05), random.uniform(0, 0.05));
    p[k % 3] = k % 2 == 0 ? 0 : std::array<double, 3>{0.2, 0.05, 0.05}[k % 3];
    double nearest = 1;
    for (const Vector3d& place : places) nearest = std::min(nearest, (place - p).norm());
    EXPECT_LT(nearest, spacing);
  }
}

std::vector<Obstacle> obstacles() {
  return {{"table", HalfSpace{}, math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, -0.004}), 0.5},
          {"ball", Sphere{0.03}, math::make_pose(Eigen::Matrix3d::Identity(), {0.1, 0.02, 0.085}),
           0.5}};
}

TEST(CandidateSearch, MissesNothingWithinReachOfAMovingBodyAndMovingObstacles) {
  auto all = obstacles();
  const double reach = 0.003, skin = 0.004;
  CandidateSearch search(surface_samples(mesh::extract_surface(bar()), bar().nodes, 0.012), all,
                         reach, skin);
  math::Random random(5);
  Eigen::Matrix3Xd positions = bar().nodes;
  int found = 0;
  const int steps = 2000;
  for (int step = 0; step < steps; ++step) {
    for (int n = 0; n < positions.cols(); ++n) {
      for (int i = 0; i < 3; ++i) positions(i, n) += random.uniform(-1e-4, 1e-4);
    }
    Obstacle& ball = all[1];
    ball.X_OB.translation() += 2e-4 * Vector3d(std::sin(0.02 * step), 0, -std::cos(0.01 * step));
    all[0].X_OB.linear() = math::exp_rotation({0.02 * std::sin(0.01 * step), 0, 0});
    ball.is_known = step % 500 < 400;
    const std::vector<Candidate>& candidates = search.find(positions);
    std::size_t next = 0;
    for (int s = 0; s < static_cast<int>(search.samples().size()); ++s) {
      for (int o = 0; o < 2; ++o) {
        const bool is_candidate = next < candidates.size() && candidates[next].sample == s &&
                                  candidates[next].obstacle == o;
        next += is_candidate;
        const double d = distance(all[o], position(search.samples()[s], positions));
        if (d <= reach) {
          ++found;
          EXPECT_TRUE(is_candidate) << "step " << step << " sample " << s << " distance " << d;
        }
        // node boxes have no extent, so that nothing beyond reach, skin and motion is listed
        if (is_candidate) {
          EXPECT_LE(d, reach + 2 * skin + 1e-12);
        }
      }
    }
    EXPECT_EQ(next, candidates.size());
  }
  EXPECT_GT(found, 1000);
  EXPECT_LT(search.searches(), steps / 4);
}

TEST(CandidateSearch, AsksTheTreeOnlyAfterMotion) {
  const auto all = obstacles();
  CandidateSearch search(surface_samples(mesh::extract_surface(bar()), bar().nodes, 1), all, 0.003,
                         0.004);
  Eigen::Matrix3Xd positions = bar().nodes;
  search.find(positions);
  // the weights of a face's centre, in absolute terms, sum to 5/3
  positions.row(2).array() += 0.0023;
  search.find(positions);
  EXPECT_EQ(search.searches(), 1);
  positions.row(2).array() += 0.0002;
  search.find(positions);
  EXPECT_EQ(search.searches(), 2);
}

TEST(CandidateSearch, AsksTheTreeWhereAnObstacleHasMoved) {
  auto all = obstacles();
  CandidateSearch search(surface_samples(mesh::extract_surface(bar()), bar().nodes, 1), all, 0.003,
                         0.004);
  search.find(bar().nodes);
  all[0].X_OB.translation().z() += 0.0039;
  search.find(bar().nodes);
  EXPECT_EQ(search.searches(), 1);
  all[0].X_OB.translation().z() += 0.0002;
  search.find(bar().nodes);
  EXPECT_EQ(search.searches(), 2);
  // by a turn about its origin, the far end of the bar's box comes nearer by 4 mm
  all[0].X_OB.linear() = math::exp_rotation({0, -0.004 / 0.205, 0});
  search.find(bar().nodes);
  EXPECT_EQ(search.searches(), 3);
  all[1].is_known = false;
  search.find(bar().nodes);
  EXPECT_EQ(search.searches(), 4);
  for (const Candidate& candidate : search.find(bar().nodes)) EXPECT_EQ(candidate.obstacle, 0);
}

}  // namespace
}  // namespace palpate::collision
