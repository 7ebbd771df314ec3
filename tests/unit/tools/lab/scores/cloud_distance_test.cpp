#include "tools/lab/scores/cloud_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/math/random.hpp"
#include "core/mesh/closest_point.hpp"

namespace palpate::scores {
namespace {

draw::TriangleMesh moved(draw::TriangleMesh mesh, const Eigen::Vector3d& by) {
  mesh.points.colwise() += by;
  return mesh;
}

TEST(CloudDistance, NearestIsThatOfExhaustiveSearch) {
  math::Random random(5);
  Eigen::Matrix3Xd points(3, 200), cloud(3, 777);
  for (double& x : points.reshaped()) x = random.uniform(-1, 1);
  for (double& x : cloud.reshaped()) x = random.uniform(-0.5, 1.5);
  const Eigen::VectorXd distances = distances_to_cloud(points, cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    EXPECT_NEAR(distances[i], (cloud.colwise() - points.col(i)).colwise().norm().minCoeff(), 1e-12);
  EXPECT_EQ(distances_to_cloud(cloud.leftCols(1), cloud)[0], 0);
  EXPECT_THROW(distances_to_cloud(points, Eigen::Matrix3Xd(3, 0)), std::invalid_argument);
  EXPECT_THROW(distances_to_surface(points, draw::TriangleMesh{cloud, Eigen::Matrix3Xi(3, 0)}),
               std::invalid_argument);
}

TEST(CloudDistance, SummaryIsWeighted) {
  const Eigen::Vector3d distances(1, 2, 4), weights(2, 1, 0);
  const DistanceSummary all = summarise_distances(distances);
  EXPECT_NEAR(all.mean, 7.0 / 3, 1e-12);
  EXPECT_NEAR(all.rms, std::sqrt(7.0), 1e-12);
  EXPECT_EQ(all.maximum, 4);
  const DistanceSummary weighted = summarise_distances(distances, weights);
  EXPECT_NEAR(weighted.mean, 4.0 / 3, 1e-12);
  EXPECT_NEAR(weighted.rms, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(weighted.maximum, 4);
}

TEST(SurfaceSamples, CoverTheSurfaceAndWeighItsArea) {
  const draw::TriangleMesh box = draw::make_box({0.3, 0.2, 0.1});
  const double spacing = 0.02;
  const SurfaceSamples samples = sample_surface(box, spacing);
  EXPECT_NEAR(samples.weights.sum(), 2 * (0.06 + 0.03 + 0.02), 1e-12);
  EXPECT_LT((samples.points * samples.weights).norm(), 1e-12);  // centroid
  EXPECT_LT(distances_to_surface(samples.points, box).maxCoeff(), 1e-12);
  math::Random random(2);
  Eigen::Matrix3Xd on_top(3, 500);
  for (Eigen::Index i = 0; i < on_top.cols(); ++i)
    on_top.col(i) << random.uniform(-0.15, 0.15), random.uniform(-0.1, 0.1), 0.05;
  EXPECT_LT(distances_to_cloud(on_top, samples.points).maxCoeff(), 2.0 / 3 * spacing);
  EXPECT_THROW(sample_surface(box, 0), std::invalid_argument);
}

TEST(SurfaceSamples, OfASurfaceThatHasBurstThereAreNoMoreThanCanBeScored) {
  draw::TriangleMesh box = draw::make_box({3000, 2000, 1000});
  const SurfaceSamples samples = sample_surface(box, 2.5e-3);
  EXPECT_NEAR(samples.weights.sum(), 2 * (6 + 3 + 2) * 1e6, 1);
  EXPECT_GT(samples.points.cols(), 1e5);
  EXPECT_LT(samples.points.cols(), 1e6);
  box.points(0, 0) = std::nan("");
  EXPECT_THROW(sample_surface(box, 2.5e-3), std::invalid_argument);
}

TEST(SurfaceDistance, NearestTriangleIsThatOfAnExhaustiveSearch) {
  // Triangles of very different size, so that the nearest one rarely has the nearest centroid.
  math::Random random(5);
  const auto anywhere = [&random](double size) {
    return Eigen::Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                           random.uniform(-size, size));
  };
  draw::TriangleMesh soup;
  soup.points.resize(3, 180);
  soup.triangles.resize(3, 60);
  for (int t = 0; t < 60; ++t) {
    const Eigen::Vector3d middle = anywhere(0.3);
    for (int corner = 0; corner < 3; ++corner) {
      soup.points.col(3 * t + corner) = middle + anywhere(t % 10 == 0 ? 0.3 : 0.02);
      soup.triangles(corner, t) = 3 * t + corner;
    }
  }
  Eigen::Matrix3Xd points(3, 300);
  for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) = anywhere(0.5);
  const Eigen::VectorXd distances = distances_to_surface(points, soup);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    ASSERT_NEAR(distances[i],
                mesh::closest_point_on_surface(points.col(i), soup.triangles, soup.points).distance,
                1e-12);
}

TEST(SurfaceDistance, ShiftedCubeHasItsAnalyticDistances) {
  const double a = 0.2, s = 0.03;
  const draw::TriangleMesh cube = draw::make_box({a, a, a});
  const SurfaceDistance d = surface_distance(cube, moved(cube, {s, 0, 0}), 0.004);
  // Over the front face s; over the back face min(s, distance to its edges); at the sides, points
  // that protrude by x are x away. By area: s / 3 + 2 s^3 / (9 a^2).
  const double mean = s / 3 + 2 * s * s * s / (9 * a * a);
  EXPECT_NEAR(d.from_first.mean, mean, 0.01 * mean);
  EXPECT_NEAR(d.from_second.mean, mean, 0.01 * mean);
  EXPECT_NEAR(d.hausdorff, s, 1e-9);
  EXPECT_LT(surface_distance(cube, cube, 0.05).hausdorff, 1e-15);
}

TEST(SurfaceDistance, ConcentricSpheresAndAPartOfASurface) {
  const SurfaceDistance d =
      surface_distance(draw::make_sphere(0.10), draw::make_sphere(0.12), 0.005);
  EXPECT_NEAR(d.from_first.mean, 0.02, 2e-4);
  EXPECT_NEAR(d.from_second.mean, 0.02, 2e-4);
  EXPECT_NEAR(d.hausdorff, 0.02, 1e-3);  // facets

  // A part has zero distance to the whole, but the whole not to the part.
  const draw::TriangleMesh box = draw::make_box({0.1, 0.1, 0.1});
  draw::TriangleMesh open = box;
  open.triangles = box.triangles.leftCols(10);  // without one face
  const SurfaceDistance part = surface_distance(open, box, 0.005);
  EXPECT_LT(part.from_first.maximum, 1e-12);
  EXPECT_NEAR(part.from_second.maximum, 0.05, 2.0 / 3 * 0.005);
  EXPECT_EQ(part.hausdorff, part.from_second.maximum);
}

}  // namespace
}  // namespace palpate::scores
