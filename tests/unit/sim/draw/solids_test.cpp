#include "sim/draw/solids.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace palpate::draw {
namespace {

/// Volume by the divergence theorem; wrong or negative if a triangle faces inwards. The sum of the
/// area vectors of a closed surface is zero.
double closed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.points.col(t[0]);
    const Eigen::Vector3d normal =
        0.5 * (mesh.points.col(t[1]) - a).cross(mesh.points.col(t[2]) - a);
    volume += a.dot(normal) / 3;
    sum += normal;
  }
  EXPECT_LT(sum.norm(), 1e-12);
  return volume;
}

TEST(Solids, AreClosedAndFaceOutward) {
  EXPECT_NEAR(closed_volume(make_box({0.2, 0.3, 0.5})), 0.03, 1e-12);
  const double cylinder = M_PI * 0.01 * 0.6;
  EXPECT_NEAR(closed_volume(make_cylinder(0.1, 0.6)), cylinder, 0.01 * cylinder);
  const double sphere = 4.0 / 3 * M_PI * 0.008;
  EXPECT_NEAR(closed_volume(make_sphere(0.2)), sphere, 0.015 * sphere);
  EXPECT_NEAR(make_arrow(0.5, 0.01).points.row(2).maxCoeff(), 0.5, 1e-12);
  EXPECT_GT(closed_volume(make_arrow(0.5, 0.01)), 0);
}

TEST(CornerNormals, RoundASphereAndKeepABoxSharp) {
  const TriangleMesh sphere = make_sphere(1);
  const Eigen::Matrix3Xd smooth = corner_normals(sphere.points, sphere.triangles, 0.7);
  double worst = 0;
  for (Eigen::Index c = 0; c < smooth.cols(); ++c) {
    const Eigen::Vector3d p = sphere.points.col(sphere.triangles(c % 3, c / 3));
    worst = std::max(worst, (smooth.col(c) - p.normalized()).norm());
  }
  EXPECT_LT(worst, 0.1);
  const TriangleMesh box = make_box({1, 2, 3});
  const Eigen::Matrix3Xd sharp = corner_normals(box.points, box.triangles, 0.7);
  for (Eigen::Index c = 0; c < sharp.cols(); ++c) {
    EXPECT_NEAR(sharp.col(c).cwiseAbs().maxCoeff(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace palpate::draw
