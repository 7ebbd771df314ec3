#include "core/solid/strain_energy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "tests/support/solid/strain_energy_tensor.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStep = 1e-5;

class Material : public testing::TestWithParam<std::string> {
 protected:
  Material() : energy_(StrainEnergy::make(GetParam())), constants_(energy_->constants().size()) {
    for (Eigen::Index i = 0; i < constants_.size(); ++i)
      constants_[i] = energy_->constants()[static_cast<std::size_t>(i)].start;
    constants_[0] = 3e4;
    constants_[1] = 0.35;
  }

  PrincipalStress at(const Vector3d& x, const VectorXd& c) const {
    PrincipalStress r;
    energy_->evaluate(x, c, r);
    return r;
  }

  /// Central difference of `f` by entry `i` of its argument.
  template <class F, class V>
  static auto difference(const F& f, V x, Eigen::Index i) {
    const double h = kStep * std::max(1.0, std::abs(x[i])), middle = x[i];
    x[i] = middle + h;
    const auto above = f(x);
    x[i] = middle - h;
    const auto below = f(x);
    return decltype(above)((above - below) / (2 * h));
  }

  std::unique_ptr<const StrainEnergy> energy_;
  VectorXd constants_;
};

TEST_P(Material, StressIsTheDerivativeOfEnergyAndTangentOfStress) {
  const Vector3d x(0.3, -0.25, 0.1);
  const PrincipalStress r = at(x, constants_);
  for (int k = 0; k < 3; ++k) {
    const double slope =
        difference([&](const Vector3d& y) { return at(y, constants_).energy; }, x, k);
    EXPECT_NEAR(slope, r.stress[k], 1e-7 * 3e4);
    const Vector3d column =
        difference([&](const Vector3d& y) { return Vector3d(at(y, constants_).stress); }, x, k);
    EXPECT_LT((column - r.tangent.col(k)).norm(), 1e-7 * r.tangent.norm());
  }
  EXPECT_LT((r.tangent - r.tangent.transpose()).norm(), 1e-13 * r.tangent.norm());
}

TEST_P(Material, DerivativesByConstantsAreThoseOfDifferences) {
  const Vector3d x(-0.4, 0.2, 0.05);
  const PrincipalStress r = at(x, constants_);
  for (Eigen::Index i = 0; i < constants_.size(); ++i) {
    const Vector3d column =
        difference([&](const VectorXd& c) { return Vector3d(at(x, c).stress); }, constants_, i);
    EXPECT_LT((column - r.by_constant.col(i)).norm(), 1e-7 * r.by_constant.col(i).norm())
        << energy_->constants()[static_cast<std::size_t>(i)].name;
  }
}

TEST_P(Material, SmallStrainIsHookes) {
  const double E = constants_[0], nu = constants_[1];
  const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const PrincipalStress r = at(Vector3d::Zero(), constants_);
  EXPECT_NEAR(r.energy, 0, 1e-12);
  EXPECT_LT(r.stress.norm(), 1e-9);
  const Matrix3d hooke = lambda * Matrix3d::Ones() + 2 * mu * Matrix3d::Identity();
  EXPECT_LT((r.tangent - hooke).norm(), 1e-9 * hooke.norm());
}

TEST_P(Material, BarWithFreeSidesBeginsWithYoungsModulusAndPoissonsRatio) {
  UniaxialStress r;
  ASSERT_TRUE(respond_uniaxially(*energy_, constants_, 1 + 1e-7, r));
  EXPECT_NEAR(r.by_stretch / 3e4, 1, 1e-5);
  EXPECT_NEAR(r.lateral_by_stretch, -0.35, 1e-5);
  EXPECT_NEAR(r.stress / 3e4, 1e-7, 1e-12);
}

TEST_P(Material, BarDerivativesAreThoseOfDifferences) {
  for (const double stretch : {0.6, 1.4}) {
    for (const double nu : {0.35, 0.5}) {
      constants_[1] = nu;
      const auto pair = [&](double at_stretch, const VectorXd& c) {
        UniaxialStress r;
        EXPECT_TRUE(respond_uniaxially(*energy_, c, at_stretch, r));
        return Eigen::Vector2d(r.stress, r.lateral);
      };
      UniaxialStress r;
      ASSERT_TRUE(respond_uniaxially(*energy_, constants_, stretch, r));
      const Eigen::Vector2d slope =
          (pair(stretch + kStep, constants_) - pair(stretch - kStep, constants_)) / (2 * kStep);
      EXPECT_NEAR(r.by_stretch, slope[0], 1e-6 * std::abs(slope[0]));
      EXPECT_NEAR(r.lateral_by_stretch, slope[1], 1e-7);
      for (Eigen::Index i = 0; i < constants_.size(); ++i) {
        if (i == 1 && nu == 0.5) continue;
        const Eigen::Vector2d by =
            difference([&](const VectorXd& c) { return pair(stretch, c); }, constants_, i);
        EXPECT_NEAR(r.by_constant[i], by[0], 1e-6 * std::max(1e-3 * 3e4, std::abs(by[0]))) << i;
        EXPECT_NEAR(r.lateral_by_constant[i], by[1], 1e-7) << i;
      }
    }
  }
}

TEST_P(Material, TensorFormAgreesWithEnergyDifferencesAndTurnsWithTheFrame) {
  Matrix3d F;
  F << 1.2, 0.1, -0.05, 0.2, 0.9, 0.15, -0.1, 0.05, 1.05;
  support::TensorStress r;
  ASSERT_TRUE(respond_to_gradient(*energy_, constants_, F, r));
  for (int k = 0; k < 9; ++k) {
    support::TensorStress above, below;
    Matrix3d G = F;
    G.data()[k] += kStep;
    ASSERT_TRUE(respond_to_gradient(*energy_, constants_, G, above));
    G.data()[k] -= 2 * kStep;
    ASSERT_TRUE(respond_to_gradient(*energy_, constants_, G, below));
    EXPECT_NEAR((above.energy - below.energy) / (2 * kStep), r.stress.data()[k], 1e-6 * 3e4);
    const Matrix3d slope = (above.stress - below.stress) / (2 * kStep);
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> column(slope.data());
    EXPECT_LT((column - r.tangent.col(k)).norm(), 1e-7 * r.tangent.norm());
  }
  const Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  support::TensorStress turned;
  ASSERT_TRUE(respond_to_gradient(*energy_, constants_, R * F, turned));
  EXPECT_LT((turned.stress - R * r.stress).norm(), 1e-10 * r.stress.norm());
  EXPECT_NEAR(turned.energy, r.energy, 1e-10 * r.energy);
}

TEST_P(Material, TensorFormHoldsWhereStretchesMeet) {
  support::TensorStress r;
  ASSERT_TRUE(respond_to_gradient(*energy_, constants_, 1.1 * Matrix3d::Identity(), r));
  for (int k = 0; k < 9; ++k) {
    support::TensorStress above, below;
    Matrix3d G = 1.1 * Matrix3d::Identity();
    G.data()[k] += 1e-4;
    ASSERT_TRUE(respond_to_gradient(*energy_, constants_, G, above));
    G.data()[k] -= 2e-4;
    ASSERT_TRUE(respond_to_gradient(*energy_, constants_, G, below));
    const Matrix3d slope = (above.stress - below.stress) / 2e-4;
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> column(slope.data());
    EXPECT_LT((column - r.tangent.col(k)).norm(), 1e-5 * r.tangent.norm());
  }
  EXPECT_FALSE(respond_to_gradient(*energy_, constants_, Vector3d(1, 1, -1).asDiagonal(), r));
}

INSTANTIATE_TEST_SUITE_P(All, Material, testing::ValuesIn(StrainEnergy::names()),
                         [](const auto& test) { return test.param; });

TEST(StrainEnergy, IncompressibleBarsFollowTheTextbook) {
  const double E = 6e4, stretch = 1.7, mu = E / 3;
  UniaxialStress r;
  const Eigen::Vector2d neo(E, 0.5);
  ASSERT_TRUE(respond_uniaxially(*StrainEnergy::make("neo_hookean"), neo, stretch, r));
  EXPECT_NEAR(r.stress, mu * (stretch - std::pow(stretch, -2)), 1e-9 * E);
  const Vector3d mooney(E, 0.5, 0.4);
  const double c10 = 0.6 * mu / 2, c01 = 0.4 * mu / 2;
  ASSERT_TRUE(respond_uniaxially(*StrainEnergy::make("mooney_rivlin"), mooney, stretch, r));
  EXPECT_NEAR(r.stress, 2 * (c10 + c01 / stretch) * (stretch - std::pow(stretch, -2)), 1e-9 * E);
  const Vector3d ogden(E, 0.5, 3.3);
  ASSERT_TRUE(respond_uniaxially(*StrainEnergy::make("ogden_1"), ogden, stretch, r));
  EXPECT_NEAR(r.stress, 2 * mu / 3.3 * (std::pow(stretch, 2.3) - std::pow(stretch, -3.3 / 2 - 1)),
              1e-9 * E);
}

TEST(StrainEnergy, FoamWithoutPoissonsRatioKeepsItsWidth) {
  UniaxialStress r;
  const Vector3d constants(5e4, 0, 6);
  ASSERT_TRUE(respond_uniaxially(*StrainEnergy::make("hyperfoam_1"), constants, 0.5, r));
  EXPECT_NEAR(r.lateral, 1, 1e-14);
  EXPECT_NEAR(r.stress, 5e4 / 6 * (std::pow(0.5, 5) - 2), 1e-8 * 5e4);
}

TEST(StrainEnergy, AnUnknownMaterialIsRefusedWithTheNamesThereAre) {
  try {
    StrainEnergy::make("rubber");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("mooney_rivlin"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::solid
