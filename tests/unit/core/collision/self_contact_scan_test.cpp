#include "core/collision/self_contact_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/math/constants.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::collision {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kLength = 0.6, kSide = 0.04;  // m

mesh::ElementMesh strip(mesh::ElementOrder order) {
  return mesh::make_element_mesh(mesh::make_box({kLength, kSide, kSide}, {15, 2, 2}), order);
}

/// The strip bent about y to an arc of `angle` rad, its neutral line in the middle.
Matrix3Xd bent(const mesh::ElementMesh& mesh, double angle) {
  Matrix3Xd x = mesh.nodes;
  const double radius = kLength / angle;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3d p = x.col(i);
    const double at = p.x() / radius, r = radius - (p.z() - kSide / 2);
    x.col(i) = Vector3d(r * std::sin(at), p.y(), radius - r * std::cos(at));
  }
  return x;
}

/// The node that is found within the turns that cover every node.
int found(SelfContactScan& scan, const Matrix3Xd& x, int looks = 400) {
  for (int i = 0; i < looks; ++i) scan.look(x);
  return scan.node();
}

class SelfContact : public testing::TestWithParam<mesh::ElementOrder> {};

TEST_P(SelfContact, IsFoundWhereTheEndsOfAStripPassThroughEachOther) {
  const mesh::ElementMesh mesh = strip(GetParam());
  SelfContactScan scan(mesh, mesh::extract_surface(mesh));
  EXPECT_EQ(found(scan, mesh.nodes), -1);
  EXPECT_EQ(found(scan, bent(mesh, 1.9 * math::kPi)), -1) << "nearly a ring";
  const Matrix3Xd closed = bent(mesh, 2.15 * math::kPi);
  const int node = found(scan, closed);
  ASSERT_GE(node, 0);
  const double x = mesh.nodes(0, node);
  EXPECT_TRUE(x < 0.1 || x > kLength - 0.1) << x;
  EXPECT_EQ(found(scan, mesh.nodes), -1) << "it ends with the contact";
}

TEST_P(SelfContact, IsNotFoundInWhatIsOnlyMovedStretchedOrCrushed) {
  const mesh::ElementMesh mesh = strip(GetParam());
  SelfContactScan scan(mesh, mesh::extract_surface(mesh));
  const Eigen::AngleAxisd turn(1.2, Vector3d(1, 2, -1).normalized());
  EXPECT_EQ(found(scan, turn.toRotationMatrix() * mesh.nodes), -1);
  for (const double factor : {0.3, 2.5})
    EXPECT_EQ(found(scan, Vector3d(factor, 1, 1).asDiagonal() * mesh.nodes), -1);
  Matrix3Xd wrong = bent(mesh, 2.15 * math::kPi);
  wrong.setConstant(std::nan(""));
  EXPECT_EQ(found(scan, wrong), -1);
  EXPECT_EQ(found(scan, Matrix3Xd::Zero(3, 5)), -1) << "of another mesh";
}

TEST_P(SelfContact, IsForgottenByAReset) {
  const mesh::ElementMesh mesh = strip(GetParam());
  SelfContactScan scan(mesh, mesh::extract_surface(mesh));
  ASSERT_GE(found(scan, bent(mesh, 2.15 * math::kPi)), 0);
  scan.reset();
  EXPECT_EQ(scan.node(), -1);
}

INSTANTIATE_TEST_SUITE_P(Elements, SelfContact,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic),
                         [](const auto& info) {
                           return info.param == mesh::ElementOrder::kLinear ? "linear"
                                                                            : "quadratic";
                         });

}  // namespace
}  // namespace palpate::collision
