#include "core/elasticity/element_stress.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/elements.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Stress = Eigen::Matrix<double, 6, 1>;

Matrix3d tensor(const Stress& s) {
  Matrix3d m;
  m << s(0), s(3), s(4), s(3), s(1), s(5), s(4), s(5), s(2);
  return m;
}

class StressOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  void expect_everywhere(const Matrix3d& F, const Matrix3d& expected) const {
    const ElementStress stress = element_stress(body_, F * body_.mesh.nodes);
    ASSERT_EQ(stress.cauchy.cols(), body_.mesh.element_count());
    for (int e = 0; e < stress.cauchy.cols(); ++e) {
      EXPECT_LT((tensor(stress.cauchy.col(e)) - expected).norm(), 1e-9 * law_.mu) << e;
      EXPECT_NEAR(stress.von_mises(e), von_mises(stress.cauchy.col(e)), 1e-12 * law_.mu);
    }
  }

  Matrix3Xd deformed() const {
    std::srand(11);
    return body_.mesh.nodes + 2e-3 * Matrix3Xd::Random(3, body_.mesh.node_count());
  }

  // Not a multiple of four elements.
  const Body body_ = make_bar({0.2, 0.05, 0.04}, {3, 1, 1}, GetParam());
  const Lame law_ = lame(body_.material);
};
INSTANTIATE_TEST_SUITE_P(Order, StressOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

// A bar stretched by e with free lateral contraction nu e bears E e times its rest section.
TEST_P(StressOfEveryOrder, IsForceOverDeformedSectionInTension) {
  const double e = 0.2, nu = body_.material.poisson_ratio;
  const double thinner = 1 - nu * e;
  Matrix3d expected = Matrix3d::Zero();
  expected(0, 0) = body_.material.young_modulus * e / (thinner * thinner);
  expect_everywhere(Eigen::Vector3d(1 + e, thinner, thinner).asDiagonal(), expected);
}

TEST_P(StressOfEveryOrder, IsThatOfAStretchBetweenWalls) {
  const double e = -0.15;
  const Eigen::Vector3d expected(2 * law_.mu + law_.lambda, law_.lambda / (1 + e),
                                 law_.lambda / (1 + e));
  expect_everywhere(Eigen::Vector3d(1 + e, 1, 1).asDiagonal(),
                    Matrix3d((e * expected).asDiagonal()));
}

TEST_P(StressOfEveryOrder, IsThatOfPureShear) {
  const double g = 0.1;
  Matrix3d F = Matrix3d::Identity(), expected = Matrix3d::Zero();
  F(0, 2) = F(2, 0) = g;
  expected(0, 2) = expected(2, 0) = 1;
  expected(0, 0) = expected(2, 2) = g;
  expect_everywhere(F, 2 * law_.mu * g / (1 - g * g) * expected);
}

TEST_P(StressOfEveryOrder, VanishesInARigidMotion) {
  expect_everywhere(rotation(2.8, {1, -2, 0.5}), Matrix3d::Zero());
}

TEST_P(StressOfEveryOrder, TurnsWithTheBody) {
  const Matrix3d R = rotation(1.9, {0.3, 1, -0.6});
  const Matrix3Xd x = deformed();
  const ElementStress before = element_stress(body_, x);
  const ElementStress after = element_stress(body_, (R * x).colwise() + Eigen::Vector3d(1, 2, 3));
  for (int e = 0; e < before.cauchy.cols(); ++e) {
    const Matrix3d s = tensor(before.cauchy.col(e));
    EXPECT_GT(s.norm(), 1e-3 * law_.mu);
    EXPECT_LT((tensor(after.cauchy.col(e)) - R * s * R.transpose()).norm(), 1e-9 * s.norm());
    EXPECT_NEAR(after.von_mises(e), before.von_mises(e), 1e-9 * before.von_mises(e));
  }
}

/// The current volume of an element's quadrature points at positions x.
template <int kNodes>
double deformed_volume(const mesh::ElementMesh& mesh, int e, const Matrix3Xd& x) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int a = 0; a < 4; ++a) corners.col(a) = mesh.nodes.col(mesh.elements(a, e));
  double volume = 0;
  for (const auto& gradients : Tetrahedron<kNodes>::gradients(corners)) {
    Matrix3d F = Matrix3d::Zero();
    for (int a = 0; a < kNodes; ++a) {
      F += x.col(mesh.elements(a, e)) * gradients.col(a).transpose();
    }
    volume += F.determinant() * tetrahedron_volume(corners) / Tetrahedron<kNodes>::kPoints;
  }
  return volume;
}

// In a velocity field v = G x the power of nodal forces equals that of the stress on grad v = G.
TEST_P(StressOfEveryOrder, WorksAsMuchAsNodalForces) {
  const Matrix3Xd x = deformed();
  const Matrix3Xd forces = Elements(body_).evaluate(x).forces;
  const ElementStress stress = element_stress(body_, x);
  for (int k = 0; k < 9; ++k) {
    Matrix3d G = Matrix3d::Zero();
    G(k / 3, k % 3) = 1;
    double of_stress = 0, scale = 0;
    for (int e = 0; e < stress.cauchy.cols(); ++e) {
      const double volume = GetParam() == mesh::ElementOrder::kLinear
                                ? deformed_volume<4>(body_.mesh, e, x)
                                : deformed_volume<10>(body_.mesh, e, x);
      of_stress += volume * tensor(stress.cauchy.col(e)).cwiseProduct(G).sum();
      scale += volume * stress.cauchy.col(e).norm();
    }
    EXPECT_NEAR(of_stress, forces.cwiseProduct(G * x).sum(), 1e-9 * scale) << k;
  }
}

TEST_P(StressOfEveryOrder, OfACrushedElementIsANumber) {
  const ElementStress flat =
      element_stress(body_, Matrix3d(Eigen::Vector3d(0, 1, 1).asDiagonal()) * body_.mesh.nodes);
  EXPECT_TRUE(flat.cauchy.allFinite());
  const ElementStress mirrored =
      element_stress(body_, Matrix3d(Eigen::Vector3d(-1, 1, 1).asDiagonal()) * body_.mesh.nodes);
  EXPECT_TRUE(mirrored.cauchy.allFinite());
  EXPECT_GT(mirrored.von_mises.minCoeff(), law_.mu);
}

TEST_P(StressOfEveryOrder, IsPublishedForTheSnapshotOfTheJob) {
  Body body = bar(GetParam());
  CorotationalQuasistatic model(body);
  model.prepare();
  EXPECT_LT(model.sensitivity().stress.von_mises.maxCoeff(), 1e-6);
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation() += Eigen::Vector3d(0.01, 0, 0.02);
  model.hold(0, X);
  settle(model, true);
  model.watch_contact(0, {});  // requests a new factorisation
  const Matrix3Xd snapshot = model.positions();
  Refactorisation* job = model.wanted_refactorisation();
  ASSERT_NE(job, nullptr);
  job->run();
  model.install(*job);
  const ElementStress& stress = model.sensitivity().stress;
  const ElementStress expected = element_stress(body, snapshot);
  EXPECT_LT((stress.cauchy - expected.cauchy).norm(), 1e-9 * expected.cauchy.norm());
  EXPECT_LT((stress.von_mises - expected.von_mises).norm(), 1e-9 * expected.von_mises.norm());
  EXPECT_GT(stress.von_mises.minCoeff(), 100.0);
}

TEST(VonMises, OfKnownStates) {
  const auto of = [](double xx, double yy, double zz, double xy, double xz, double yz) {
    return von_mises((Stress() << xx, yy, zz, xy, xz, yz).finished());
  };
  EXPECT_NEAR(of(-7, 0, 0, 0, 0, 0), 7, 1e-12);
  EXPECT_NEAR(of(5, 5, 5, 0, 0, 0), 0, 1e-12);
  EXPECT_NEAR(of(0, 0, 0, 0, -4, 0), 4 * std::sqrt(3.0), 1e-12);
  // Principal stresses 3, 1, -2 plus a pressure: sqrt((2^2 + 3^2 + 5^2) / 2).
  EXPECT_NEAR(of(13, 11, 8, 0, 0, 0), std::sqrt(19.0), 1e-12);
  EXPECT_NEAR(of(1, 1, 0, 2, 0, 0), of(3, -1, 0, 0, 0, 0), 1e-12) << "turned by 45 degrees";
}

TEST(ElementStress, RefusesPositionsOfAnotherMesh) {
  const Body body = bar();
  EXPECT_THROW(element_stress(body, Matrix3Xd::Zero(3, 5)), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity
