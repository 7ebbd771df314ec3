#include "sim/object/hexahedral_grid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

const Eigen::Vector3d kOrigin(0.1, -0.2, 0.3);
const Eigen::Vector3d kHexahedralGridSize(0.5, 0.06, 0.04);

HexahedralGrid grid() { return even_grid(kOrigin, kHexahedralGridSize, {14, 2, 1}); }

TEST(HexahedralGrid, CountsNodesAndSharesOutTheVolume) {
  const HexahedralGrid g = grid();
  EXPECT_EQ(g.node_count(), 29 * 5 * 3);
  EXPECT_EQ(g.element_count(), 28);
  EXPECT_NEAR(g.nodal_volumes().sum(), kHexahedralGridSize.prod(), 1e-15);
  EXPECT_GT(g.nodal_volumes().minCoeff(), 0);
  EXPECT_TRUE(g.nodes().col(0).isApprox(kOrigin));
  EXPECT_TRUE(g.nodes().col(g.node_count() - 1).isApprox(kOrigin + kHexahedralGridSize));
}

TEST(HexahedralGrid, SurfaceIsClosedAndPointsOutward) {
  const HexahedralGrid g = grid();
  double volume = 0;
  double area = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& t : g.triangles().colwise()) {
    const Eigen::Vector3d a = g.nodes().col(t[0]), b = g.nodes().col(t[1]), c = g.nodes().col(t[2]);
    const Eigen::Vector3d normal = 0.5 * (b - a).cross(c - a);
    sum += normal;
    area += normal.norm();
    volume += a.dot(normal) / 3;
  }
  EXPECT_NEAR(volume, kHexahedralGridSize.prod(), 1e-12);
  EXPECT_NEAR(area, 2 * (0.5 * 0.06 + 0.06 * 0.04 + 0.04 * 0.5), 1e-12);
  EXPECT_LT(sum.norm(), 1e-12);
}

TEST(HexahedralGrid, LocatesPointsAndReproducesQuadraticFields) {
  const HexahedralGrid g = grid();
  const auto field = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x() * p.x() + p.y(), p.y() * p.z() * p.z(), 1 + p.x() * p.y());
  };
  Eigen::Matrix3Xd values(3, g.node_count());
  for (int n = 0; n < g.node_count(); ++n) values.col(n) = field(g.nodes().col(n));
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = kOrigin + (Eigen::Vector3d::Random() + Eigen::Vector3d::Ones())
                                            .cwiseProduct(0.5 * kHexahedralGridSize);
    const MaterialPoint point = g.locate(p);
    EXPECT_EQ(point.outside, 0);
    EXPECT_LT((point.interpolate(values) - field(p)).norm(), 1e-13);
  }
  for (int n = 0; n < g.node_count(); ++n) {
    EXPECT_LT((g.locate(g.nodes().col(n)).interpolate(g.nodes()) - g.nodes().col(n)).norm(), 1e-14);
  }
  EXPECT_NEAR(g.locate(kOrigin + Eigen::Vector3d(-0.003, 0.06, 0.044)).outside, 0.005, 1e-12);
}

TEST(HexahedralGrid, PatchAreasAddUpToThePatch) {
  const HexahedralGrid g = grid();
  const double end = kOrigin.x() + kHexahedralGridSize.x();
  EXPECT_NEAR(g.patch_areas({{end, -9, -9}, {end, 9, 9}}).sum(), 0.06 * 0.04, 1e-15);
  // Deeper than one element: the end face and four side faces.
  const double inner = end - 0.5 / 14;
  EXPECT_NEAR(g.patch_areas({{inner, -9, -9}, {end, 9, 9}}).sum(),
              0.06 * 0.04 + 2 * (0.06 + 0.04) * 0.5 / 14, 1e-15);
  // A single node still represents some area; a box in the interior none.
  EXPECT_GT(g.patch_areas({kOrigin, kOrigin}).sum(), 0);
  const Eigen::Vector3d middle = kOrigin + 0.5 * kHexahedralGridSize;
  EXPECT_EQ(g.patch_areas({middle, middle}).sum(), 0);
}

}  // namespace
}  // namespace palpate::object
