#include "tools/lab/cases/case_face.hpp"

#include <gtest/gtest.h>

#include "core/math/rigid.hpp"
#include "tests/unit/tools/lab/cases/case_folder.hpp"

namespace palpate::cases {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

const Vector3d kSize(0.2, 0.05, 0.04);

class FaceOfBar : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  const mesh::MeshWithGroups bar_ = bar_mesh(kSize, {3, 3, 2});
  const mesh::ElementMesh mesh_ = mesh::make_element_mesh(bar_.mesh, GetParam());
  const SurfacePatch patch_{mesh_, bar_.groups.at("load").triangles};
};

TEST_P(FaceOfBar, HasItsAreaAndAllItsNodes) {
  EXPECT_NEAR(patch_.area(), 0.05 * 0.04, 1e-17);
  EXPECT_EQ(patch_.nodes(), mesh::nodes_in_box(mesh_, {0.2, 0, 0}, kSize));
  EXPECT_FALSE(patch_.empty());
  EXPECT_TRUE(SurfacePatch(mesh_, Eigen::Matrix3Xi()).empty());
}

TEST_P(FaceOfBar, NodalForcesHaveTheResultantsOfTheTraction) {
  // Rotation about the centre of the face: torque = integral of k r^2 = k (Iy + Iz).
  const double k = 1e5;
  const Vector3d middle(0.2, 0.025, 0.02);
  const Matrix3Xd forces = patch_.nodal_forces(
      [&](const Vector3d& p) -> Vector3d { return k * Vector3d::UnitX().cross(p - middle); });
  Vector3d torque = Vector3d::Zero();
  for (int n = 0; n < mesh_.node_count(); ++n)
    torque += (mesh_.nodes.col(n) - middle).cross(Vector3d(forces.col(n)));
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12);
  if (GetParam() == mesh::ElementOrder::kQuadratic) {
    const double polar = 0.05 * 0.04 * (0.05 * 0.05 + 0.04 * 0.04) / 12;
    EXPECT_NEAR(torque.x(), k * polar, 1e-12);
  }
  // Work on a field in the span of the shape functions equals that of the traction.
  const Matrix3Xd even = patch_.nodal_forces([](const Vector3d&) { return Vector3d(0, 3, 0); });
  double work = 0;
  for (int n = 0; n < mesh_.node_count(); ++n) work += even(1, n) * mesh_.nodes(2, n);
  EXPECT_NEAR(work, 3 * 0.05 * 0.04 * 0.02, 1e-16);
}

TEST_P(FaceOfBar, MeanIsThatOfALinearField) {
  Matrix3Xd u = mesh_.nodes;
  u.row(0) = 2 * mesh_.nodes.row(1) - mesh_.nodes.row(2);
  EXPECT_LT((patch_.mean(u) - Vector3d(0.03, 0.025, 0.02)).norm(), 1e-15);
}

TEST_P(FaceOfBar, TwistIsTheAngleOfARotationAndNotOfAStretch) {
  const double angle = 0.7;
  Matrix3Xd x = math::exp_rotation(angle * Vector3d::UnitX()) * (1.1 * mesh_.nodes);
  x.colwise() += Vector3d(0.3, -0.2, 0.1);
  EXPECT_NEAR(patch_.twist(x), angle, 1e-12);
  EXPECT_NEAR(patch_.twist(mesh_.nodes), 0, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Orders, FaceOfBar,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST(SurfacePatch, RefusesTrianglesOfAnotherMesh) {
  const mesh::ElementMesh mesh =
      mesh::make_element_mesh(mesh::make_box(kSize, {2, 2, 2}), mesh::ElementOrder::kQuadratic);
  EXPECT_THROW(SurfacePatch(mesh, Eigen::Vector3i(0, 2, 26)), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::cases
