#include "core/solid/solid_membrane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::solid {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

MembraneVector skin() {
  MembraneVector p;
  p << 20, 30, 40, 0.4, 2e5, 3e-3;
  return p;
}

std::vector<double> lines(double from, double to, int cells) {
  std::vector<double> result;
  for (int k = 0; k <= cells; ++k) result.push_back(from + (to - from) * k / cells);
  return result;
}

SolidMembrane two_pads() {
  return SolidMembrane(lines(-0.04, 0.06, 10), lines(-0.03, 0.03, 6),
                       {{{-0.01, -0.01}, {0, 0.01}}, {{0.02, -0.01}, {0.03, 0.02}}});
}

TEST(MembraneResponse, IsTheDerivativeOfItsEnergy) {
  const Matrix2d F = (Matrix2d() << 1.1, 0.05, -0.08, 0.97).finished();
  MembraneResponse at, ahead, behind;
  ASSERT_TRUE(membrane_response(F, skin(), at));
  const double h = 1e-6;
  for (int k = 0; k < 4; ++k) {
    Matrix2d step = Matrix2d::Zero();
    step.data()[k] = h;
    ASSERT_TRUE(membrane_response(F + step, skin(), ahead));
    ASSERT_TRUE(membrane_response(F - step, skin(), behind));
    EXPECT_NEAR((ahead.energy - behind.energy) / (2 * h), at.stress.data()[k],
                1e-7 * at.stress.norm());
    const Matrix2d slope = (ahead.stress - behind.stress) / (2 * h);
    EXPECT_LT((Eigen::Map<const Eigen::Vector4d>(slope.data()) - at.tangent.col(k)).norm(),
              1e-7 * at.tangent.norm());
  }
  for (int k = 0; k < kMembraneParameters; ++k) {
    MembraneVector step = MembraneVector::Zero();
    step[k] = h * skin()[k];
    ASSERT_TRUE(membrane_response(F, skin() + step, ahead));
    ASSERT_TRUE(membrane_response(F, skin() - step, behind));
    const Matrix2d slope = (ahead.stress - behind.stress) / (2 * step[k]);
    EXPECT_LT((Eigen::Map<const Eigen::Vector4d>(slope.data()) - at.by_parameter.col(k)).norm(),
              1e-6 * at.stress.norm() / skin()[k])
        << k;
  }
}

/// Without stiffening: the incompressible Neo-Hookean sheet, mu (l^2 - l^-4) / l under equibiaxial
/// stretch.
TEST(MembraneResponse, IsNeoHookeanWithoutStiffening) {
  MembraneVector p = skin();
  p[kStiffening] = p[kFibre] = 0;
  MembraneResponse r;
  const double l = 1.3;
  ASSERT_TRUE(membrane_response(l * Matrix2d::Identity(), p, r));
  EXPECT_NEAR(r.stress(0, 0), p[kShear] * (l - std::pow(l, -5)), 1e-12);
}

/// Betti: the mutual forces of pads are symmetric at small strain.
TEST(SolidMembrane, IsReciprocal) {
  const SolidMembrane membrane = two_pads();
  SolidMembrane::State first, second;
  const double u = 1e-6;
  MembraneVector p = skin();
  ASSERT_TRUE(membrane.solve(p, {Vector2d(u, 0), Vector2d::Zero()}, first, false));
  ASSERT_TRUE(membrane.solve(p, {Vector2d::Zero(), Vector2d(0, u)}, second, false));
  EXPECT_NEAR(first.forces[1].y() / second.forces[0].x(), 1, 1e-3);
  EXPECT_GT(first.forces[0].x(), 0);
  EXPECT_GT(std::abs(first.forces[1].y()), 1e-9);
}

/// Far from its ends a long pad is the edge of a strip: displacements decay as exp(-x / d) with d^2
/// = 4 shear / foundation.
TEST(SolidMembrane, DecaysOnItsFoundation) {
  const SolidMembrane membrane(lines(-0.01, 0.2, 84), lines(-0.2, 0.2, 8),
                               {{{-0.01, -0.2}, {0, 0.2}}});
  MembraneVector p = skin();
  p[kFibre] = 0;
  SolidMembrane::State state;
  ASSERT_TRUE(membrane.solve(p, {Vector2d(1e-6, 0)}, state, false));
  const auto at = [&](double x) {
    const SolidMembrane::Place place = membrane.locate({x, 0.001});
    double u = 0;
    for (int a = 0; a < 9; ++a) u += place.weights[a] * state.u[2 * place.nodes[a]];
    return u;
  };
  EXPECT_NEAR(at(0.012) / at(0.002), std::exp(-0.01 / std::sqrt(4 * 20 / 2e5)), 0.005);
}

TEST(SolidMembrane, SlopesMatchDifferences) {
  const SolidMembrane membrane = two_pads();
  const std::vector<Vector2d> motions = {{-4e-3, 5e-4}, {0, 0}};
  const auto solved = [&](const MembraneVector& p) {
    SolidMembrane::State state;
    EXPECT_TRUE(membrane.solve(p, motions, state, true));
    return state;
  };
  const SolidMembrane::State at = solved(skin());
  for (int k = 0; k < kMembraneParameters; ++k) {
    MembraneVector step = MembraneVector::Zero();
    step[k] = 1e-4 * skin()[k];
    const SolidMembrane::State ahead = solved(skin() + step), behind = solved(skin() - step);
    const Eigen::VectorXd slope = (ahead.u - behind.u) / (2 * step[k]);
    EXPECT_LT((at.slopes.col(k) - slope).norm(), 1e-6 * slope.norm() + 1e-16) << k;
    const Vector2d force = (ahead.forces[0] - behind.forces[0]) / (2 * step[k]);
    EXPECT_LT((at.force_slopes[0].col(k) - force).norm(), 1e-6 * force.norm()) << k;
  }
}

TEST(SolidMembrane, RefusesWhatIsNone) {
  EXPECT_THROW(SolidMembrane({0, 0}, {0, 1}, {}), std::invalid_argument);
  EXPECT_THROW(two_pads().locate({1, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::solid
