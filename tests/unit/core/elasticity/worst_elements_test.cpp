#include "core/elasticity/worst_elements.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/elasticity/element_stress.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

double dot(const ElementStrain& one, const mesh::ElementMesh& mesh, const Matrix3Xd& dx) {
  double sum = 0;
  for (int a = 0; a < one.by_node.cols(); ++a)
    sum += one.by_node.col(a).dot(dx.col(mesh.elements(a, one.element)));
  return sum;
}

class WorstElementsOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  /// For a homogeneous deformation.
  void expect(Strain strain, const Matrix3d& F, double value) const {
    WorstElements worst(body_, strain);
    int found = 0;
    for (const ElementStrain& one : worst.look(F * body_.mesh.nodes)) {
      if (one.element < 0) continue;
      ++found;
      EXPECT_NEAR(one.value, value, 1e-9 * std::max(1.0, value));
    }
    EXPECT_EQ(found, WorstElements::kCount);
    EXPECT_NEAR(worst.peak(), value, 1e-9 * std::max(1.0, value));
  }
  Matrix3Xd random(double size) const {
    return size * Matrix3Xd::Random(3, body_.mesh.node_count());
  }

  const Body body_ = make_bar({0.2, 0.05, 0.04}, {5, 1, 1}, GetParam());
  const Lame law_ = lame(body_.material);
};
INSTANTIATE_TEST_SUITE_P(Order, WorstElementsOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(WorstElementsOfEveryOrder, AreThoseOfAStretchedBar) {
  const double e = 0.2, thinner = 1 - body_.material.poisson_ratio * e;
  const Matrix3d F = Vector3d(1 + e, thinner, thinner).asDiagonal();
  expect(Strain::kStress, F, body_.material.young_modulus * e / (thinner * thinner));
  expect(Strain::kStretch, F, 1 + e);
}

// F = I + g e_x e_y^T: its largest stretch is g/2 + sqrt(1 + g^2/4), and it rotates by atan(g/2).
TEST_P(WorstElementsOfEveryOrder, AreThoseOfSimpleShear) {
  const double g = 0.3;
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = g;
  expect(Strain::kStretch, F, g / 2 + std::sqrt(1 + g * g / 4));
  const Matrix3d R = rotation(-std::atan(g / 2), Vector3d::UnitZ());
  const Matrix3d E = R.transpose() * F - Matrix3d::Identity();
  const Matrix3d P = R * (2 * law_.mu * E + law_.lambda * E.trace() * Matrix3d::Identity());
  const Matrix3d s = P * F.transpose();  // det F = 1
  const Eigen::Matrix<double, 6, 1> stress =
      (Eigen::Matrix<double, 6, 1>() << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2))
          .finished();
  expect(Strain::kStress, F, von_mises(stress));
}

TEST_P(WorstElementsOfEveryOrder, FeelNoRigidMotion) {
  const Matrix3d R = rotation(2.8, {1, -2, 0.5});
  expect(Strain::kStress, R, 0);
  expect(Strain::kStretch, R, 1);
  // Nor do strained ones: the derivative along a rotation is zero.
  const Matrix3Xd x = body_.mesh.nodes + random(2e-3);
  const Matrix3Xd turn = math::cross_matrix({0.3, -0.8, 0.5}) * x;
  for (const Strain strain : {Strain::kStress, Strain::kStretch}) {
    WorstElements worst(body_, strain);
    for (const ElementStrain& one : worst.look(x)) {
      const double scale = one.by_node.norm() * 0.1;
      EXPECT_LT(std::abs(dot(one, body_.mesh, turn)), 1e-10 * scale);
      EXPECT_LT(one.by_node.rowwise().sum().norm(), 1e-10 * one.by_node.norm());
    }
  }
}

TEST_P(WorstElementsOfEveryOrder, FollowTheirNodesAsCentralDifferencesDo) {
  std::srand(7);
  const Matrix3Xd x = rotation(1.1, {0.2, 1, 1}) * (body_.mesh.nodes + random(2e-3));
  for (const Strain strain : {Strain::kStress, Strain::kStretch}) {
    for (int direction = 0; direction < 4; ++direction) {
      const Matrix3Xd dx = random(1);
      WorstElements worst(body_, strain), plus(body_, strain), minus(body_, strain);
      // All elements, so that the selected ones are the same.
      const auto look = [](WorstElements& one, const Matrix3Xd& at) {
        for (int i = 0; i < 4; ++i) one.look(at);
        return one.look(at);
      };
      const double h = 1e-7;
      const auto now = look(worst, x), up = look(plus, x + h * dx), down = look(minus, x - h * dx);
      for (int k = 0; k < WorstElements::kCount; ++k) {
        ASSERT_EQ(now[k].element, up[k].element);
        ASSERT_EQ(now[k].element, down[k].element);
        const double difference = (up[k].value - down[k].value) / (2 * h);
        EXPECT_NEAR(dot(now[k], body_.mesh, dx), difference, 1e-5 * now[k].by_node.norm());
      }
    }
  }
}

TEST_P(WorstElementsOfEveryOrder, AreTheGreatestOfAllOnceEachHasBeenLookedAt) {
  std::srand(5);
  WorstElements worst(body_, Strain::kStress);
  worst.look(body_.mesh.nodes + random(1e-3));  // others were the worst before
  const Matrix3Xd x = body_.mesh.nodes + random(2e-3);
  for (int i = 0; i <= body_.mesh.element_count() / WorstElements::kLook; ++i) worst.look(x);
  const ElementStress all = element_stress(body_, x);
  std::vector<double> expected(all.von_mises.data(), all.von_mises.data() + all.von_mises.size());
  std::sort(expected.rbegin(), expected.rend());
  std::set<int> elements;
  for (const ElementStrain& one : worst.look(x)) {
    elements.insert(one.element);
    EXPECT_NEAR(one.value, all.von_mises(one.element), 1e-9 * one.value) << "as is published";
    EXPECT_GE(one.value, expected[WorstElements::kCount - 1] * (1 - 1e-9));
  }
  EXPECT_EQ(static_cast<int>(elements.size()), WorstElements::kCount);
  EXPECT_NEAR(worst.peak(), expected[0], 1e-9 * expected[0]);
}

// By the hand's motion, through the sensitivity of a new factorisation.
TEST_P(WorstElementsOfEveryOrder, FollowTheHandAsCentralDifferencesDo) {
  SolverOptions options;
  options.tolerance = 1e-10;
  options.accuracy = 0;
  CorotationalQuasistatic model(body_, options);
  model.prepare();
  const auto settled_at = [&](const math::Pose& X) {
    model.hold(0, X);
    for (int i = 0; i < 4; ++i) settle(model, true);
  };
  math::Pose X = body_.grasps[0].X_OG_rest;
  X.translation() += Vector3d(0.004, 0.01, -0.015);
  X.linear() = rotation(0.3, {0, 1, 0.4});
  settled_at(X);
  ASSERT_TRUE(
      model.restore(model.positions(), model.velocities()));  // requests a new factorisation
  model.step(kDt);
  refactor(model);
  for (int i = 0; i < 4; ++i) model.step(kDt);
  const Sensitivity::Motion S = model.sensitivity().dx_dxi[0];
  const Matrix3Xd at = model.positions();
  for (const Strain strain : {Strain::kStress, Strain::kStretch}) {
    for (int k = 0; k < 6; ++k) {
      const double h = k < 3 ? 2e-6 : 2e-5;
      std::array<std::array<ElementStrain, WorstElements::kCount>, 2> sides;
      for (int side = 0; side < 2; ++side) {
        math::Vector6d xi = math::Vector6d::Zero();
        xi[k] = side == 0 ? h : -h;
        math::Pose moved = X;
        moved.translation() += xi.head<3>();
        moved.linear() = math::exp_rotation(xi.tail<3>()) * X.linear();
        settled_at(moved);
        WorstElements worst(body_, strain);
        sides[side] =
            worst.look(model.positions());  // the first elements, regardless of their values
      }
      WorstElements worst(body_, strain);
      double scale = 0, off = 0;
      const auto now = worst.look(at);
      for (int i = 0; i < WorstElements::kCount; ++i) {
        ASSERT_EQ(now[i].element, sides[0][i].element);
        ASSERT_EQ(now[i].element, sides[1][i].element);
        const Matrix3Xd dx = Eigen::Map<const Matrix3Xd>(S.col(k).data(), 3, at.cols());
        const double difference = (sides[0][i].value - sides[1][i].value) / (2 * h);
        off = std::max(off, std::abs(dot(now[i], body_.mesh, dx) - difference));
        scale = std::max(scale, std::abs(difference));
      }
      EXPECT_LT(off, 1e-5 * scale) << k;
    }
  }
}

TEST_P(WorstElementsOfEveryOrder, OfCrushedElementsAreNumbers) {
  for (const double x : {0.0, -1.0}) {
    const Matrix3Xd flat = Matrix3d(Vector3d(x, 1, 1).asDiagonal()) * body_.mesh.nodes;
    for (const Strain strain : {Strain::kStress, Strain::kStretch}) {
      WorstElements worst(body_, strain);
      for (const ElementStrain& one : worst.look(flat)) {
        EXPECT_TRUE(std::isfinite(one.value));
        EXPECT_TRUE(one.by_node.allFinite());
      }
    }
  }
}

}  // namespace
}  // namespace palpate::elasticity
