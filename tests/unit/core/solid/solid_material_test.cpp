#include "core/solid/solid_material.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/math/rigid.hpp"
#include "tests/support/solid/strain_energy_tensor.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;

const Matrix3d kF = (Matrix3d() << 1.2, 0.3, -0.1, -0.2, 0.9, 0.15, 0.05, 0.25, 1.1).finished();

SolidCoefficients every_constant() { return {3e4, 1e4, 5e3, 6e4, 0}; }

TEST(SolidMaterial, StressAndTangentAreDerivativesOfTheEnergy) {
  const SolidCoefficients c = every_constant();
  PointResponse at, ahead, behind;
  ASSERT_TRUE(point_response(kF, c, true, at));
  const double h = 1e-5;
  for (int k = 0; k < 9; ++k) {
    Matrix3d step = Matrix3d::Zero();
    step.data()[k] = h;
    ASSERT_TRUE(point_response(kF + step, c, true, ahead));
    ASSERT_TRUE(point_response(kF - step, c, true, behind));
    EXPECT_NEAR((ahead.energy - behind.energy) / (2 * h), at.stress.data()[k],
                1e-8 * at.stress.norm());
    const Matrix3d slope = (ahead.stress - behind.stress) / (2 * h);
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> flat(slope.data());
    EXPECT_LT((flat - at.tangent.col(k)).norm(), 1e-8 * at.tangent.norm());
  }
  EXPECT_LT((at.tangent - at.tangent.transpose()).norm(), 1e-12 * at.tangent.norm());
}

TEST(SolidMaterial, StressDoesNotCareWhereTheBodyIsTurned) {
  const Matrix3d R = math::exp_rotation({0.7, -1.1, 2.0});
  PointResponse at, turned;
  ASSERT_TRUE(point_response(kF, every_constant(), false, at));
  ASSERT_TRUE(point_response(R * kF, every_constant(), false, turned));
  EXPECT_LT((turned.stress - R * at.stress).norm(), 1e-12 * at.stress.norm());
}

/// Hooke's law at small strain, for any split of the shear and bulk moduli.
TEST(SolidMaterial, SmallStrainGivesYoungsModulusAndPoissonsRatio) {
  const double E = 2.6e5, nu = 0.42;
  const SolidCoefficients c = make_solid_material(E, nu, 0.3, 0.7).coefficients;
  SolidCoefficients uniform = c;  // one strain for a whole element: J_mean = J
  uniform.bulk_point += c.bulk_mean;
  const double strain = 1e-6;
  const Matrix3d F = Eigen::Vector3d(1 + strain, 1 - nu * strain, 1 - nu * strain).asDiagonal();
  PointResponse response;
  ASSERT_TRUE(point_response(F, uniform, false, response));
  EXPECT_NEAR(response.stress(0, 0), E * strain, 1e-4 * E * strain);
  EXPECT_NEAR(response.stress(1, 1), 0, 1e-4 * E * strain);
}

/// The materials by invariants and by principal stretches are implemented separately, since their
/// volumetric laws differ; at constant volume they must agree.
TEST(SolidMaterial, WithoutChangeOfVolumeItIsTheMaterialByStretches) {
  const Matrix3d F = kF / std::cbrt(kF.determinant());
  const double E = 30e3, nu = 0.4;
  for (const double share : {0.0, 0.3}) {
    const auto by_stretches = StrainEnergy::make(share > 0 ? "mooney_rivlin" : "neo_hookean");
    Eigen::VectorXd constants(share > 0 ? 3 : 2);
    constants.head(2) << E, nu;
    if (share > 0) constants[2] = share;
    support::TensorStress one;
    PointResponse other;
    ASSERT_TRUE(respond_to_gradient(*by_stretches, constants, F, one));
    ASSERT_TRUE(point_response(F, make_solid_material(E, nu, share).coefficients, false, other));
    EXPECT_NEAR(one.energy, other.energy, 1e-12 * E);
    const auto deviator = [&](const Matrix3d& P) {
      const Matrix3d tau = P * F.transpose();
      return Matrix3d(tau - tau.trace() / 3 * Matrix3d::Identity());
    };
    EXPECT_LT((deviator(one.stress) - deviator(other.stress)).norm(), 1e-11 * E) << share;
    EXPECT_GT(deviator(one.stress).norm(), 1e-2 * E);
  }
}

TEST(SolidMaterial, SlopesAreDerivativesOfTheConstants) {
  const double E = 2.6e5, nu = 0.48, h = 1e-6;
  const SolidMaterial m = make_solid_material(E, nu, 0.3, 0.7);
  const auto numbers = [](const SolidCoefficients& c) {
    return Eigen::Matrix<double, 5, 1>(
        (Eigen::Matrix<double, 5, 1>() << c.c10, c.c01, c.c20, c.bulk_point, c.bulk_mean)
            .finished());
  };
  const auto at = [&](double young, double poisson) {
    return numbers(make_solid_material(young, poisson, 0.3, 0.7).coefficients);
  };
  const Eigen::VectorXd by_young = (at(E * (1 + h), nu) - at(E * (1 - h), nu)) / (2 * h * E);
  const Eigen::VectorXd by_poisson = (at(E, nu + h) - at(E, nu - h)) / (2 * h);
  EXPECT_LT((by_young - numbers(m.by_young)).norm(), 1e-8 * numbers(m.by_young).norm());
  EXPECT_LT((by_poisson - numbers(m.by_poisson)).norm(), 1e-7 * numbers(m.by_poisson).norm());
}

TEST(SolidMaterial, RefusesWhatIsNoSolid) {
  EXPECT_THROW(make_solid_material(0, 0.3), std::invalid_argument);
  EXPECT_THROW(make_solid_material(1e5, 0.5), std::invalid_argument);
  PointResponse response;
  EXPECT_FALSE(point_response(-Matrix3d::Identity(), every_constant(), true, response));
}

}  // namespace
}  // namespace palpate::solid
