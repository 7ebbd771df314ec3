#include "core/mesh/point_locator.hpp"

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace palpate::mesh {
namespace {

const Eigen::Vector3d kPointLocatorSize(0.3, 0.2, 0.1);

Eigen::Vector3d random_point(math::Random& random, double margin) {
  Eigen::Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = random.uniform(-margin, kPointLocatorSize[i] + margin);
  return p;
}

/// A box whose inner nodes are randomly displaced, so that elements are irregular.
ElementMesh shaken_box(ElementOrder order) {
  math::Random random(3);
  TetrahedralMesh box = make_box(kPointLocatorSize, {4, 4, 3});
  for (int n = 0; n < box.node_count(); ++n) {
    for (int i = 0; i < 3; ++i) {
      const bool inner = box.nodes(i, n) > 1e-9 && box.nodes(i, n) < kPointLocatorSize[i] - 1e-9;
      if (inner) box.nodes(i, n) += random.uniform(-0.006, 0.006);
    }
  }
  return make_element_mesh(box, order);
}

class Locator : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(Locator, InterpolatesRestPositionsExactly) {
  const ElementMesh mesh = shaken_box(GetParam());
  const PointLocator locator(mesh);
  math::Random random(1);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d p = random_point(random, 0);
    const PointWeights weights = locator.locate(p);
    EXPECT_EQ(weights.outside, 0);
    EXPECT_EQ(weights.count, mesh.nodes_per_element());
    EXPECT_LT((weights.interpolate(mesh.nodes) - p).norm(), 1e-14);
    double sum = 0;
    for (int i = 0; i < weights.count; ++i) sum += weights.weights[i];
    EXPECT_NEAR(sum, 1, 1e-13);
  }
}

TEST_P(Locator, InterpolatesFieldsOfItsOrderExactly) {
  const ElementMesh mesh = shaken_box(GetParam());
  const bool quadratic = GetParam() == ElementOrder::kQuadratic;
  const auto field = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    Eigen::Vector3d value(1 + p.x() - 2 * p.y(), 3 * p.z(), p.x() + p.y() + p.z());
    if (quadratic)
      value += Eigen::Vector3d(p.x() * p.y(), p.z() * p.z(), p.y() * p.z() - p.x() * p.x());
    return value;
  };
  Eigen::Matrix3Xd values(3, mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) values.col(n) = field(mesh.nodes.col(n));
  const PointLocator locator(mesh);
  math::Random random(2);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d p = random_point(random, 0.02);  // extrapolation too
    EXPECT_LT((locator.locate(p).interpolate(values) - field(p)).norm(), 1e-12);
  }
}

TEST_P(Locator, SaysHowFarOutsideAPointLies) {
  const ElementMesh mesh = shaken_box(GetParam());
  const PointLocator locator(mesh);
  math::Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d p = random_point(random, 0.05);
    const Eigen::Vector3d nearest = p.cwiseMax(0).cwiseMin(kPointLocatorSize);
    EXPECT_NEAR(locator.locate(p).outside, (p - nearest).norm(), 1e-12);
  }
}

TEST_P(Locator, NodesAndBordersAreInside) {
  const ElementMesh mesh = shaken_box(GetParam());
  const PointLocator locator(mesh);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const PointWeights weights = locator.locate(mesh.nodes.col(n));
    EXPECT_EQ(weights.outside, 0);
    // At a node its own shape function is 1 and all others 0.
    for (int i = 0; i < weights.count; ++i) {
      EXPECT_NEAR(weights.weights[i], weights.nodes[i] == n ? 1 : 0, 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, Locator,
                         ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic));

TEST(Locator, PassesOverElementsWithoutVolume) {
  TetrahedralMesh box = make_box(kPointLocatorSize, {1, 1, 1});
  box.tetrahedra.conservativeResize(4, 7);
  box.tetrahedra.col(6) = box.tetrahedra.col(0);
  box.tetrahedra(3, 6) = box.tetrahedra(2, 6);
  const ElementMesh mesh = make_element_mesh(box, ElementOrder::kLinear);
  const Eigen::Vector3d p = box.nodes.col(box.tetrahedra(2, 6));
  EXPECT_LT((PointLocator(mesh).locate(p).interpolate(mesh.nodes) - p).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate::mesh
