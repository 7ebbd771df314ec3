#include "core/math/rigid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/math/random.hpp"

namespace palpate::math {
namespace {

Eigen::Vector3d rigid_random_vector(Random& random, double scale = 1) {
  return scale * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
}

Pose random_pose(Random& random) {
  return make_pose(exp_rotation(rigid_random_vector(random)), rigid_random_vector(random));
}

TEST(Rigid, CrossMatrixIsTheCrossProduct) {
  Random random(1);
  const Eigen::Vector3d a = rigid_random_vector(random), b = rigid_random_vector(random);
  EXPECT_LT((cross_matrix(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Rigid, ExpEqualsTheMatrixExponential) {
  Random random(2);
  for (const double scale : {0.0, 1e-12, 1e-7, 1e-4, 1e-2, 1.0, 3.0}) {
    const Eigen::Vector3d w = rigid_random_vector(random, scale);
    const Eigen::Matrix3d expected = cross_matrix(w).exp();
    EXPECT_LT((exp_rotation(w) - expected).norm(), 1e-14) << scale;
  }
}

TEST(Rigid, LogInvertsExpAtEveryAngle) {
  Random random(3);
  for (const double angle : {0.0, 1e-15, 1e-9, 1e-5, 0.1, 1.0, 2.0, 3.0, M_PI - 1e-7}) {
    const Eigen::Vector3d w = angle * rigid_random_vector(random).normalized();
    EXPECT_LT((log_rotation(exp_rotation(w)) - w).norm(), 1e-14 + 1e-15 * angle) << angle;
  }
  // At pi either sign of the axis is correct.
  const Eigen::Vector3d w = M_PI * rigid_random_vector(random).normalized();
  const Eigen::Vector3d log = log_rotation(exp_rotation(w));
  EXPECT_LT(std::min((log - w).norm(), (log + w).norm()), 1e-14);
}

TEST(Rigid, InverseLeftJacobianIsTheDerivativeOfLog) {
  Random random(4);
  for (const double angle : {0.0, 1e-6, 5e-3, 0.02, 0.5, 1.5, 2.8}) {
    const Eigen::Vector3d w = angle * rigid_random_vector(random).normalized();
    const Eigen::Matrix3d R = exp_rotation(w);
    const Eigen::Matrix3d J = inverse_left_jacobian(w);
    const double h = 1e-5;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d difference =
          (log_rotation(exp_rotation(e) * R) - log_rotation(exp_rotation(-e) * R)) / (2 * h);
      EXPECT_LT((J.col(i) - difference).norm(), 1e-8) << angle;
    }
  }
}

TEST(Rigid, TransformKeepsPowerAndComposes) {
  Random random(5);
  const Pose X_AB = random_pose(random), X_BC = random_pose(random);
  const Wrench F_C = {rigid_random_vector(random), rigid_random_vector(random)};
  const Wrench once = transform(X_AB * X_BC, F_C);
  const Wrench twice = transform(X_AB, transform(X_BC, F_C));
  EXPECT_LT((once.vector() - twice.vector()).norm(), 1e-13);

  // A force through a point has the torque given by the lever arm.
  const Eigen::Vector3d p_B = rigid_random_vector(random), f_B = rigid_random_vector(random);
  const Wrench F_A = transform(X_AB, {f_B, p_B.cross(f_B)});
  EXPECT_LT((F_A.torque - (X_AB * p_B).cross(X_AB.linear() * f_B)).norm(), 1e-13);
}

TEST(Rigid, MovedReferencesGiveTheSamePower) {
  Random random(6);
  const Wrench F = {rigid_random_vector(random), rigid_random_vector(random)};
  const Twist V = {rigid_random_vector(random), rigid_random_vector(random)};
  const Eigen::Vector3d offset = rigid_random_vector(random);
  const double power = F.vector().dot(V.vector());
  EXPECT_NEAR(move_reference(F, offset).vector().dot(move_reference(V, offset).vector()), power,
              1e-12);
}

TEST(Rigid, TwistOfAPointIsItsFiniteDifference) {
  Random random(7);
  const Twist V = {rigid_random_vector(random), rigid_random_vector(random)};
  const Eigen::Vector3d offset = rigid_random_vector(random);
  const double h = 1e-6;
  const auto point = [&](double t) -> Eigen::Vector3d {
    return t * V.linear + exp_rotation(t * V.angular) * offset;
  };
  EXPECT_LT((move_reference(V, offset).linear - (point(h) - point(-h)) / (2 * h)).norm(), 1e-9);
}

TEST(Rigid, UnitQuaternionsAreRecognised) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  const double good[][4] = {{1, 0, 0, 0}, {0.5, -0.5, 0.5, -0.5}, {1.0004, 0, 0, 0}};
  const double bad[][4] = {{0, 0, 0, 0},   {1.001, 0, 0, 0},    {1, 1, 0, 0},
                           {1, nan, 0, 0}, {infinite, 0, 0, 0}, {0.99, 0, 0, 0}};
  for (const auto& q : good) EXPECT_TRUE(is_unit_quaternion(q)) << q[0];
  for (const auto& q : bad) EXPECT_FALSE(is_unit_quaternion(q)) << q[0] << " " << q[1];
}

TEST(Rigid, QuaternionsRoundTrip) {
  Random random(8);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3d R = exp_rotation(rigid_random_vector(random, 2));
    double wxyz[4];
    wxyz_from_rotation(R, wxyz);
    EXPECT_GE(wxyz[0], 0);
    EXPECT_TRUE(is_unit_quaternion(wxyz));
    EXPECT_LT((rotation_from_wxyz(wxyz) - R).norm(), 1e-14);
    for (double& c : wxyz) c *= 1.0003;
    EXPECT_LT((rotation_from_wxyz(wxyz) - R).norm(), 1e-14);
  }
  // 90 degrees about z takes x to y.
  const double quarter[4] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  EXPECT_LT(
      (rotation_from_wxyz(quarter) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
      1e-15);
}

}  // namespace
}  // namespace palpate::math
