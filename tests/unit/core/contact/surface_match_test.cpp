#include "core/contact/surface_match.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/mesh/closest_point.hpp"

namespace palpate::contact {
namespace {

using Eigen::Vector3d;

/// The bar bent to an arc about y of this radius, m, with its underside unchanged.
Vector3d arc(const Vector3d& p, double radius) {
  const double angle = p.x() / radius, r = radius - p.z();
  return {r * std::sin(angle), p.y(), radius - r * std::cos(angle)};
}

class SurfaceMatchTest : public ::testing::Test {
 protected:
  void bend(mesh::ElementOrder order, double radius) {
    mesh_ = mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, {10, 1, 1}), order);
    rest_ = mesh_.nodes;
    surface_ = mesh::extract_surface(mesh_);
    for (int i = 0; i < mesh_.node_count(); ++i) mesh_.nodes.col(i) = arc(rest_.col(i), radius);
    matcher_ = std::make_unique<SurfaceMatcher>(surface_);
    matcher_->take(mesh_.nodes);
  }
  mesh::ElementMesh mesh_;
  Eigen::Matrix3Xd rest_;
  mesh::Surface surface_;
  std::unique_ptr<SurfaceMatcher> matcher_;
};

TEST_F(SurfaceMatchTest, CurvedFacesFollowAnArcThatFlatOnesCut) {
  constexpr double kRadius = 0.4;
  bend(mesh::ElementOrder::kQuadratic, kRadius);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> along(0.05, 0.45), across(0.01, 0.05), off(-0.01, 0.01);
  double worst = 0, worst_flat = 0;
  for (int i = 0; i < 300; ++i) {
    const double distance = off(random);
    const Vector3d upper(along(random), across(random), 0.06);
    const Vector3d p = arc(upper + Vector3d(0, 0, distance), kRadius);
    const SurfaceMatch match = matcher_->find(p);
    ASSERT_EQ(match.count, 6);
    const Vector3d normal =
        (arc(upper + Vector3d(0, 0, 1e-6), kRadius) - arc(upper, kRadius)) * 1e6;
    EXPECT_GT(match.normal.dot(normal), 0.999);
    worst = std::max(worst, std::abs(match.normal.dot(p - match.position) - distance));
    worst_flat = std::max(
        worst_flat,
        std::abs(mesh::closest_point_on_surface(p, surface_.triangles, mesh_.nodes).distance -
                 std::abs(distance)));
    Vector3d interpolated = Vector3d::Zero(), weights = Vector3d::Zero();
    for (int k = 0; k < match.count; ++k) {
      interpolated += match.weights[k] * mesh_.nodes.col(match.nodes[k]);
      weights[0] += match.weights[k];
    }
    EXPECT_LT((interpolated - match.position).norm(), 1e-12);
    EXPECT_NEAR(weights[0], 1, 1e-12);
  }
  EXPECT_LT(worst, 5e-5);
  EXPECT_GT(worst_flat, 5e-4) << "or the test shows nothing";
}

TEST_F(SurfaceMatchTest, OnFlatFacesItFindsWhatAnExhaustiveSearchFinds) {
  bend(mesh::ElementOrder::kLinear, 0.3);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> somewhere(-0.2, 0.7);
  for (int i = 0; i < 300; ++i) {
    const Vector3d p(somewhere(random), somewhere(random), somewhere(random));
    EXPECT_NEAR(matcher_->find(p).distance,
                mesh::closest_point_on_surface(p, surface_.triangles, mesh_.nodes).distance, 1e-12);
  }
}

TEST(SurfaceMatcher, WithoutASurfaceNothingIsFound) {
  EXPECT_EQ(SurfaceMatcher(mesh::Surface()).find({0, 0, 0}).count, 0);
}

TEST_F(SurfaceMatchTest, EdgesAreWhereFacesMeetAtAnAngleAndStayThereWhenTheyBend) {
  bend(mesh::ElementOrder::kQuadratic, 0.4);
  const SurfaceEdges edges(rest_, surface_);
  EXPECT_EQ(edges.count(), 4 * 10 + 2 * 4);  // and not where the triangles of a side meet
  const auto is_near = [&](const Vector3d& at_rest, double distance) {
    return edges.is_near(matcher_->find(arc(at_rest, 0.4)), distance);
  };
  EXPECT_TRUE(is_near({0.23, 0.005, 0.06}, 0.006));
  EXPECT_FALSE(is_near({0.23, 0.005, 0.06}, 0.004));
  EXPECT_FALSE(is_near({0.23, 0.03, 0.06}, 0.028));
  EXPECT_TRUE(is_near({0.49, 0.03, 0.06}, 0.012));
  EXPECT_FALSE(is_near({0.23, 0, 0.06}, 0));
}

/// Noisy points of two sides at a right angle, compared with these sides.
TEST_F(SurfaceMatchTest, NoiseHasAMeanOnlyWithinTwoDeviationsOfAnEdge) {
  bend(mesh::ElementOrder::kQuadratic, 0.4);
  mesh_.nodes = rest_;
  matcher_->take(mesh_.nodes);
  const SurfaceEdges edges(rest_, surface_);
  constexpr double kNoise = 1.5e-3;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> along(0.1, 0.4), from_edge(0, 10 * kNoise);
  std::normal_distribution<double> normal(0, kNoise);
  std::array<double, 2> sum{};  // at the middle of a side, next to the edge
  std::array<int, 2> count{};
  double at_edge = 0;
  constexpr int kPoints = 40000;
  const auto residual = [&](const Vector3d& seen, bool& is_near_edge) {
    const SurfaceMatch match = matcher_->find(seen);
    is_near_edge = edges.is_near(match, 2 * kNoise);
    return match.normal.dot(seen - match.position);
  };
  for (int i = 0; i < kPoints; ++i) {
    const double off = from_edge(random);
    const Vector3d noise(normal(random), normal(random), normal(random));
    const Vector3d point =
        i % 2 == 0 ? Vector3d(along(random), off, 0.06) : Vector3d(along(random), 0, 0.06 - off);
    bool is_near_edge = false;
    const double z = residual(point + noise, is_near_edge);
    sum[is_near_edge] += z;
    ++count[is_near_edge];
    at_edge += residual(Vector3d(point.x(), 0, 0.06) + noise, is_near_edge) / kPoints;
  }
  const double on_face = sum[0] / count[0] / kNoise, near_edge = sum[1] / count[1] / kNoise;
  std::printf("mean of the residual, in deviations: at the edge %.2f, within two %.2f, else %.3f\n",
              at_edge / kNoise, near_edge, on_face);
  EXPECT_GT(std::abs(near_edge), 0.1) << "or there is nothing to leave out";
  EXPECT_LT(std::abs(on_face), 0.03);
}

}  // namespace
}  // namespace palpate::contact
