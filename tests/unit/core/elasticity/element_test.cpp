#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/elasticity/block_matrix.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/math/polar.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr mesh::ElementOrder kOrders[] = {mesh::ElementOrder::kLinear,
                                          mesh::ElementOrder::kQuadratic};

class ElementsOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  const Body body_ = make_bar({0.2, 0.05, 0.04}, {3, 3, 3}, GetParam());
  const ElementSet elements_{body_.mesh, body_.material};
};

TEST_P(ElementsOfEveryOrder, VolumeAndMassAreThoseOfTheBox) {
  const double volume = 0.2 * 0.05 * 0.04;
  EXPECT_NEAR(elements_.volume(), volume, 1e-12 * volume);
  const double mass = volume * body_.material.density;
  EXPECT_NEAR(elements_.nodal_mass().sum(), mass, 1e-12 * mass);
  // Second moments about O: the consistent mass integrates products of linear fields exactly.
  Eigen::VectorXd x = body_.mesh.nodes.row(0).transpose();
  Eigen::VectorXd y = body_.mesh.nodes.row(1).transpose();
  double total = 0, xx = 0, xy = 0;
  Eigen::MatrixXd m;
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.mass(e, m);
    const Eigen::VectorXi nodes = body_.mesh.elements.col(e);
    total += m.sum();
    xx += x(nodes).dot(m * x(nodes));
    xy += x(nodes).dot(m * y(nodes));
  }
  EXPECT_NEAR(total, mass, 1e-12 * mass);
  EXPECT_NEAR(xx, mass * 0.2 * 0.2 / 3, 1e-12 * mass);
  EXPECT_NEAR(xy, mass * 0.2 * 0.05 / 4, 1e-12 * mass);
}

// Under an affine map every point has the same stress: interior nodes feel no force, and the force
// on a face is P n times its area, P written from the definition of the energy.
TEST_P(ElementsOfEveryOrder, PatchTest) {
  Matrix3d F;
  F << 1.05, 0.03, -0.02, 0.01, 0.94, 0.04, 0.02, -0.05, 1.02;
  F = rotation(0.7, {1, -2, 0.5}) * F;
  const Matrix3Xd x = (F * body_.mesh.nodes).colwise() + Vector3d(0.1, 0.2, 0.3);
  ElementSet::State state = elements_.make_state();
  Matrix3Xd f = Matrix3Xd::Zero(3, x.cols());
  const double energy = elements_.add_forces(x, 0, state, f);

  const Lame law = lame(body_.material);
  const Matrix3d R = math::polar_rotation(F);
  const double trace = (R.transpose() * F).trace() - 3;
  const Matrix3d P = 2 * law.mu * (F - R) + law.lambda * trace * R;
  const double density = law.mu * (F - R).squaredNorm() + 0.5 * law.lambda * trace * trace;
  EXPECT_NEAR(energy, density * elements_.volume(), 1e-12 * energy);

  const Matrix3Xd traction = face_load(body_.mesh, 0.2, P.col(0) * 0.05 * 0.04);
  int inside = 0, on_end = 0;
  for (int i = 0; i < x.cols(); ++i) {
    const Vector3d p = body_.mesh.nodes.col(i);
    const bool within_section =
        p.y() > 1e-9 && p.y() < 0.05 - 1e-9 && p.z() > 1e-9 && p.z() < 0.04 - 1e-9;
    if (!within_section || p.x() < 1e-9) continue;
    const bool is_end = p.x() > 0.2 - 1e-9;
    ++(is_end ? on_end : inside);
    const Vector3d expected = is_end ? Vector3d(traction.col(i)) : Vector3d::Zero();
    EXPECT_LT((f.col(i) - expected).norm(), 1e-12 * P.norm());
  }
  EXPECT_GT(inside, 0);
  EXPECT_GT(on_end, 0);
}

TEST_P(ElementsOfEveryOrder, SemidefiniteTangentHasNoNegativeEigenvalueAndEqualsTheExactOneAtRest) {
  std::srand(3);
  Eigen::MatrixXd exact, semidefinite, warped;
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kExact, 0, exact);
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kSemidefinite, 0, semidefinite);
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kWarped, 0, warped);
  EXPECT_LT((exact - semidefinite).norm(), 1e-9 * exact.norm());
  EXPECT_LT((exact - warped).norm(), 1e-9 * exact.norm());

  // Squeezed to half its size the element is unstable.
  Matrix3Xd x = 0.5 * body_.mesh.nodes + 0.003 * Matrix3Xd::Random(3, body_.mesh.node_count());
  elements_.stiffness(1, x, Tangent::kExact, 0, exact);
  elements_.stiffness(1, x, Tangent::kSemidefinite, 0, semidefinite);
  const auto least = [](const Eigen::MatrixXd& K) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues()(0);
  };
  EXPECT_LT(least(exact), -1e-3 * exact.norm());
  EXPECT_GT(least(semidefinite), -1e-12 * exact.norm());
}

INSTANTIATE_TEST_SUITE_P(Order, ElementsOfEveryOrder, testing::ValuesIn(kOrders));

TEST(ElementSet, RefusesAnElementWithoutVolume) {
  Body body = make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  std::swap(body.mesh.elements(0, 2), body.mesh.elements(1, 2));
  EXPECT_THROW(ElementSet(body.mesh, body.material), std::invalid_argument);
}

TEST(PointKernel, FindsTheRotationFromAnyStartAndForInvertedPoints) {
  std::srand(5);
  PointState state;
  for (int trial = 0; trial < 200; ++trial) {
    LaneMatrix F, R;
    for (Lanes& component : F) component = Lanes::Random();
    update_rotation(F, state, R);
    for (int lane = 0; lane < 4; ++lane) {
      Matrix3d f, r;
      for (int k = 0; k < 9; ++k) {
        f(k / 3, k % 3) = F[k](lane);
        r(k / 3, k % 3) = R[k](lane);
      }
      EXPECT_NEAR(r.determinant(), 1, 1e-12);
      // The maximum of tr(R^T F); its value is unique where R is not.
      EXPECT_NEAR((r.transpose() * f).trace(), (math::polar_rotation(f).transpose() * f).trace(),
                  1e-12);
    }
  }
}

TEST(BodyCheck, NamesWhatIsWrong) {
  const Body good = make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  EXPECT_NO_THROW(good.check());
  const auto refused = [&](auto&& spoil) {
    Body body = good;
    spoil(body);
    EXPECT_THROW(body.check(), std::invalid_argument);
  };
  refused([](Body& b) { b.material.poisson_ratio = 0.5; });
  refused([](Body& b) { b.material.young_modulus = 0; });
  refused([](Body& b) { b.material.density = -1; });
  refused([](Body& b) { b.fixed_nodes.push_back(8); });
  refused([](Body& b) { b.fixed_nodes.push_back(b.grasps[0].nodes[0]); });
  refused([](Body& b) { b.grasps[0].nodes.clear(); });
  refused([](Body& b) { b.mesh.elements(0, 0) = -1; });
  refused([](Body& b) { b.mesh.elements.resize(4, 0); });
  refused([](Body& b) { b.mesh.nodes(0, 0) = std::nan(""); });
}

}  // namespace
}  // namespace palpate::elasticity
