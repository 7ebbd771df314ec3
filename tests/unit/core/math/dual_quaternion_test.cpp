#include "core/math/dual_quaternion.hpp"

#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "core/math/random.hpp"

namespace palpate::math {
namespace {

Eigen::Vector3d random_vector(Random& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// The motion of a constant twist in unit time.
Eigen::Matrix4d exponential(const Twist& V) {
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() = cross_matrix(V.angular);
  generator.topRightCorner<3, 1>() = V.linear;
  return generator.exp();
}

TEST(DualQuaternion, ProductAndConjugateAreThoseOfPoses) {
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    const Pose a = make_pose(exp_rotation(random_vector(random)), random_vector(random));
    const Pose b = make_pose(exp_rotation(random_vector(random)), random_vector(random));
    const DualQuaternion qa = DualQuaternion::from_pose(a), qb = DualQuaternion::from_pose(b);
    EXPECT_LT(((qa * qb).pose().matrix() - (a * b).matrix()).norm(), 1e-13);
    EXPECT_LT((qa.conjugate().pose().matrix() - a.inverse().matrix()).norm(), 1e-13);
    EXPECT_LT(((qa * qa.conjugate()).pose().matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-13);
  }
}

TEST(DualQuaternion, LogIsTheTwistWhoseExponentialIsTheMotion) {
  Random random(2);
  for (const double angle : {0.0, 1e-13, 1e-10, 1e-6, 1e-3, 0.5, 2.0, 3.1, M_PI}) {
    const Eigen::Vector3d axis = random_vector(random).normalized();
    const Pose X = make_pose(exp_rotation(angle * axis), random_vector(random));
    const Screw screw = DualQuaternion::from_pose(X).log();
    EXPECT_NEAR(screw.theta, angle, 1e-12);
    EXPECT_NEAR(screw.l.norm(), 1, 1e-13);
    if (angle > 1e-3) {
      EXPECT_NEAR(screw.l.dot(screw.m), 0, 1e-10);
    }
    EXPECT_TRUE(screw.m.allFinite());
    EXPECT_LT((exponential(screw.twist()) - X.matrix()).norm(), 3e-12) << angle;
  }
}

TEST(DualQuaternion, LogOfAKnownScrew) {
  // A quarter turn about the line through (1, 2, 0) along z, with 0.3 m along it.
  const Eigen::Vector3d point(1, 2, 0), axis = Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d R = exp_rotation(M_PI / 2 * axis);
  const Pose X = make_pose(R, point - R * point + 0.3 * axis);
  const Screw screw = DualQuaternion::from_pose(X).log();
  EXPECT_NEAR(screw.theta, M_PI / 2, 1e-14);
  EXPECT_NEAR(screw.d, 0.3, 1e-14);
  EXPECT_LT((screw.l - axis).norm(), 1e-14);
  EXPECT_LT((screw.m - point.cross(axis)).norm(), 1e-14);
}

TEST(DualQuaternion, LogOfTheIdentityIsZero) {
  const Screw screw = DualQuaternion().log();
  EXPECT_EQ(screw.twist().vector().norm(), 0);
}

TEST(DualQuaternion, BothSignsHaveTheSameLog) {
  Random random(3);
  DualQuaternion q = DualQuaternion::from_pose(
      make_pose(exp_rotation(random_vector(random)), random_vector(random)));
  const Vector6d expected = q.log().twist().vector();
  q.real.coeffs() *= -1;
  q.dual.coeffs() *= -1;
  EXPECT_LT((q.log().twist().vector() - expected).norm(), 1e-13);
}

}  // namespace
}  // namespace palpate::math
