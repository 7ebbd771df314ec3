#include "core/elasticity/strain_scan.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

class StrainScanOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  void turn(StrainScan& scan, const Eigen::Matrix3Xd& x) const {
    for (int k = 0; k < body_.mesh.element_count(); k += StrainScan::kLook) scan.look(x);
  }

  const Body body_ = make_bar({0.2, 0.05, 0.04}, {8, 2, 2}, GetParam());
};
INSTANTIATE_TEST_SUITE_P(Order, StrainScanOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(StrainScanOfEveryOrder, FindsTheLargestPrincipalStrainOfEitherSign) {
  const Eigen::Matrix3d R = rotation(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  for (const Eigen::Vector3d& stretch :
       {Eigen::Vector3d(1.25, 0.9, 1), Eigen::Vector3d(1.1, 0.7, 1.05), Eigen::Vector3d(1, 1, 1)}) {
    StrainScan scan(body_);
    turn(scan, R * (stretch.asDiagonal() * body_.mesh.nodes));
    EXPECT_NEAR(scan.largest(), (stretch.array() - 1).abs().maxCoeff(), 1e-7);
  }
}

TEST_P(StrainScanOfEveryOrder, FindsOneStrainedElementWithinATurnAndForgetsItWithinTwo) {
  StrainScan scan(body_);
  turn(scan, body_.mesh.nodes);
  EXPECT_LT(scan.largest(), 1e-7);
  const int last = static_cast<int>(body_.mesh.element_count()) - 1;
  Eigen::Matrix3Xd x = body_.mesh.nodes;
  for (const int node : body_.mesh.elements.col(last)) x.col(node) *= 1.5;
  turn(scan, x);
  EXPECT_GT(scan.largest(), 0.4);
  turn(scan, body_.mesh.nodes);
  turn(scan, body_.mesh.nodes);
  EXPECT_LT(scan.largest(), 1e-7);
}

// A beam bent to a circle of radius R has the strains z / R; the mean over the outermost elements
// is that at their centres.
TEST(StrainScan, FindsThatOfABentBeam) {
  constexpr double kRadius = 0.25, kHeight = 0.04;
  const Body body = make_bar({0.2, 0.05, kHeight}, {16, 2, 4}, mesh::ElementOrder::kQuadratic);
  Eigen::Matrix3Xd x = body.mesh.nodes;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double angle = body.mesh.nodes(0, i) / kRadius;
    const double radius = kRadius + body.mesh.nodes(2, i) - kHeight / 2;
    x(0, i) = radius * std::sin(angle);
    x(2, i) = radius * std::cos(angle);
  }
  StrainScan scan(body);
  for (int k = 0; k < body.mesh.element_count(); k += StrainScan::kLook) scan.look(x);
  const double at_surface = kHeight / 2 / kRadius, cell = kHeight / 4 / kRadius;
  EXPECT_LT(scan.largest(), at_surface);
  EXPECT_GT(scan.largest(), at_surface - 0.5 * cell);
}

TEST(StrainScan, IgnoresPositionsOfAnotherMesh) {
  const Body body = make_bar({0.2, 0.05, 0.04}, {8, 2, 2}, mesh::ElementOrder::kQuadratic);
  StrainScan scan(body);
  const Eigen::Matrix3Xd x = 1.2 * body.mesh.nodes, other = x.leftCols(5);
  scan.look(other);
  EXPECT_EQ(scan.largest(), 0);
  scan.look(x);
  EXPECT_NEAR(scan.largest(), 0.2, 1e-9);
  scan.reset();
  EXPECT_EQ(scan.largest(), 0);
}

}  // namespace
}  // namespace palpate::elasticity
