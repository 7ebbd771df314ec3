#include "core/math/polar.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

#include "core/math/random.hpp"
#include "core/math/rigid.hpp"
#include "tests/support/polar_derivative.hpp"

namespace palpate::math {
namespace {

Eigen::Vector3d polar_random_vector(Random& random) {
  return {random.normal(), random.normal(), random.normal()};
}

Eigen::Matrix3d random_matrix(Random& random) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i) = random.normal();
  return m;
}

Eigen::Matrix3d random_rotation(Random& random) {
  return exp_rotation(3 * random.uniform() * polar_random_vector(random).normalized());
}

/// R V diag(stretch) V^T.
Eigen::Matrix3d with_stretches(const Eigen::Matrix3d& R, const Eigen::Vector3d& stretch,
                               Random& random) {
  const Eigen::Matrix3d V = random_rotation(random);
  return R * V * stretch.asDiagonal() * V.transpose();
}

void expect_rotation(const Eigen::Matrix3d& R) {
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_GT(R.determinant(), 0);
}

TEST(Polar, RecoversTheRotationOfAStretchedFrame) {
  Random random(1);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Matrix3d R = random_rotation(random);
    const Eigen::Vector3d stretch(random.uniform(0.2, 3), random.uniform(0.2, 3),
                                  random.uniform(0.2, 3));
    const Eigen::Matrix3d F = with_stretches(R, stretch, random);
    const Eigen::Matrix3d cold = polar_rotation(F);
    expect_rotation(cold);
    EXPECT_LT((cold - R).norm(), 1e-13);
    // From a neighbour, and from anywhere.
    for (const double angle : {0.01, 0.5, 3.0}) {
      Eigen::Quaterniond warm(R * exp_rotation(angle * polar_random_vector(random).normalized()));
      EXPECT_LT((polar_rotation(F, warm) - R).norm(), 1e-13) << angle;
      EXPECT_LT((warm.toRotationMatrix() - R).norm(), 1e-13);
    }
  }
}

TEST(Polar, EqualsSingularValueDecompositionOnRandomMatrices) {
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Matrix3d F = random_matrix(random);  // half of them inverted
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = F.determinant() < 0 ? -1 : 1;
    const Eigen::Matrix3d expected =
        svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    // Largest rotation of R by rounding of F alone: the inverse of the smallest sum of two
    // stretches.
    const double gap = svd.singularValues()[1] + sign * svd.singularValues()[2];
    const Eigen::Matrix3d R = polar_rotation(F);
    expect_rotation(R);
    EXPECT_LT((R - expected).norm(), 1e-14 + 2e-14 * svd.singularValues()[0] / gap);
    if (gap > 0.1) {
      EXPECT_LT((R - expected).norm(), 1e-12);
    }
  }
}

TEST(Polar, IsTheNearestRotation) {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3d F = random_matrix(random);
    const Eigen::Matrix3d R = polar_rotation(F);
    for (int j = 0; j < 50; ++j) {
      EXPECT_LE((F - R).norm(), (F - random_rotation(random)).norm() + 1e-12);
      EXPECT_LE((F - R).norm(),
                (F - R * exp_rotation(1e-3 * polar_random_vector(random))).norm() + 1e-12);
    }
  }
}

TEST(Polar, SingularAndTinyMatricesGiveARotation) {
  Random random(4);
  const Eigen::Matrix3d R = random_rotation(random);
  const Eigen::Vector3d stretches[] = {{1, 1, 0},    {1, 0.5, 1e-14},         {1, 0, 0},
                                       {0, 0, 0},    {1, 1e-9, 1e-9},         {1, 1, -1},
                                       {-1, -1, -1}, {1e-200, 1e-200, 1e-200}};
  for (const Eigen::Vector3d& stretch : stretches) {
    const Eigen::Matrix3d F = with_stretches(R, stretch, random);
    const Eigen::Matrix3d nearest = polar_rotation(F);
    expect_rotation(nearest);
    EXPECT_LE((F - nearest).norm(), (F - R).norm() + 1e-12);
  }
  // A flat element still has a unique result.
  const Eigen::Matrix3d flat = with_stretches(R, {1.3, 0.8, 0}, random);
  EXPECT_LT((polar_rotation(flat) - R).norm(), 1e-12);
}

TEST(Polar, NotFiniteGivesTheIdentity) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(1, 2) = bad;
    Eigen::Quaterniond warm(0, 1, 0, 0);
    EXPECT_EQ(polar_rotation(F, warm), Eigen::Matrix3d::Identity());
    EXPECT_EQ(warm.w(), 1);
  }
}

TEST(Polar, WarmStartsDoNotDriftFromRotations) {
  Random random(5);
  Eigen::Quaterniond warm = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 100000; ++k) {
    F = exp_rotation(0.02 * polar_random_vector(random)) * F;
    if (k % 1000 == 0) F = polar_rotation(F);
    polar_rotation(F, warm);
  }
  expect_rotation(warm.toRotationMatrix());
}

TEST(Polar, DerivativeEqualsFiniteDifference) {
  Random random(6);
  int compared = 0;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Matrix3d F = random_matrix(random);
    const Eigen::Matrix3d R = polar_rotation(F);
    const Eigen::Matrix3d A = polar_spin(R, F);
    if (A.norm() > 10) continue;  // finite differences are meaningless near a flip
    ++compared;
    const Eigen::Matrix3d dF = random_matrix(random);
    const double h = 1e-5;
    const Eigen::Matrix3d difference =
        (polar_rotation(F + h * dF) - polar_rotation(F - h * dF)) / (2 * h);
    EXPECT_LT((support::polar_rotation_derivative(R, A, dF) - difference).norm(), 1e-6);
  }
  EXPECT_GT(compared, 200);
}

TEST(Polar, DerivativeIsBoundedWhereTheRotationJumps) {
  Random random(7);
  const Eigen::Matrix3d R = random_rotation(random);
  const Eigen::Matrix3d flip = with_stretches(R, {1, 0.5, -0.5}, random);
  const Eigen::Matrix3d A = polar_spin(polar_rotation(flip), flip);
  EXPECT_TRUE(A.allFinite());
  EXPECT_LE(A.norm(), 2e6);
  EXPECT_EQ(polar_spin(R, Eigen::Matrix3d::Zero()).norm(), 0);
}

}  // namespace
}  // namespace palpate::math
