#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/stepping.hpp"

// A free body under backward Euler: x1 = x0 + h v1, M (v1 - v0) = h f(x1). Inner forces have no
// moment about any point, x1 x f(x1) = 0 in sum, so that the angular momentum L = x x M v changes
// by
//   L1 - L0 = x1 x M (v1 - v0) + h v1 x M v0 = -h v1 x M (v1 - v0),
// in sum over all pairs of nodes, M being the consistent mass matrix. Nothing else may be lost.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// a x M b, summed over all pairs of nodes, with the consistent mass.
Vector3d moment(const ElementSet& elements, const Matrix3Xd& a, const Matrix3Xd& b) {
  Vector3d sum = Vector3d::Zero();
  Eigen::MatrixXd mass;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.mass(e, mass);
    const Eigen::VectorXi nodes = elements.mesh().elements.col(e);
    const Matrix3Xd left = a(Eigen::all, nodes), right = b(Eigen::all, nodes) * mass;
    for (int i = 0; i < left.cols(); ++i) sum += left.col(i).cross(right.col(i));
  }
  return sum;
}

Body free_bar(mesh::ElementOrder order, double young_modulus) {
  Body body = make_bar({0.1, 0.05, 0.05}, {2, 1, 1}, order, {young_modulus, 0.35, 300});
  body.fixed_nodes.clear();
  body.damping = {0, 0};
  return body;
}

SolverOptions converged() {
  SolverOptions options;
  options.tolerance = 1e-9;
  options.accuracy = 0;
  options.iterations = 60;
  return options;
}

/// Positions and velocities of rigid motion about the centre of mass.
Matrix3Xd spin_velocities(const Body& body, const Vector3d& spin) {
  const Vector3d centre(0.05, 0.025, 0.025);
  Matrix3Xd v(3, body.mesh.node_count());
  for (int i = 0; i < v.cols(); ++i) v.col(i) = spin.cross(body.mesh.nodes.col(i) - centre);
  return v;
}

class FreeBody : public testing::TestWithParam<mesh::ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Order, FreeBody,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

// Soft, tumbling about a general axis and shaken: every step against the identity above.
TEST_P(FreeBody, ChangesItsAngularMomentumAsBackwardEulerMust) {
  for (const double stiffness_factor : {0.0, 0.002}) {
    Body body = free_bar(GetParam(), 1e5);
    body.damping.stiffness_factor = stiffness_factor;
    CorotationalDynamic model(body, converged());
    model.prepare();
    std::srand(11);
    const Matrix3Xd v0 =
        spin_velocities(body, {8, -15, 12}) + 0.1 * Matrix3Xd::Random(3, body.mesh.node_count());
    ASSERT_TRUE(model.restore(body.mesh.nodes, v0));
    Matrix3Xd v = v0;
    Vector3d L = moment(model.elements(), body.mesh.nodes, v), lost = Vector3d::Zero();
    const Vector3d first = L;
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(model.step(kDt).status, StepStatus::kConverged) << "step " << i;
      refactor(model);
      const Vector3d change =
          -kDt * moment(model.elements(), model.velocities(), model.velocities() - v);
      const Vector3d now = moment(model.elements(), model.positions(), model.velocities());
      ASSERT_LT((now - L - change).norm(), 0.01 * change.norm()) << "step " << i;
      lost -= change;
      L = now;
      v = model.velocities();
    }
    EXPECT_LT((first - L - lost).norm(), 1e-3 * lost.norm());
    EXPECT_GT(lost.norm(), 0.01 * first.norm()) << "there was something to lose";
  }
}

// A rigid body that turns by a_n in step n has L_n = I sin(a_n) / h, since v = (x1 - x0) / h. In
// the identity above that is, with v0 = spin x x0 to begin with,
//   tan a_1 = h spin,    tan a_{n+1} = sin a_n / (2 - cos a_n):
// the spin falls by the factor 1 - (h spin)^2 in a step, half of that in the first one. A stiff
// body, whose centrifugal strain is some 1e-6, does the same.
TEST_P(FreeBody, LosesSpinAsARigidOneDoes) {
  const Vector3d spin(0, 0, 30);
  const Body body = free_bar(GetParam(), 1e8);
  SolverOptions options = converged();
  options.tolerance = 1e-7;
  CorotationalDynamic model(body, options);
  model.prepare();
  const Matrix3Xd v = spin_velocities(body, spin);
  ASSERT_TRUE(model.restore(body.mesh.nodes, v));
  const double inertia = moment(model.elements(), body.mesh.nodes, v).z() / spin.z();
  const double mass = 300 * 0.1 * 0.05 * 0.05;
  ASSERT_NEAR(inertia, mass * (0.1 * 0.1 + 0.05 * 0.05) / 12, 1e-9 * inertia);

  double expected = inertia * spin.z(), angle = std::atan(kDt * spin.z()), last = expected;
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(model.step(kDt).status, StepStatus::kConverged) << "step " << i;
    refactor(model);
    const double next = inertia * std::sin(angle) / kDt;
    const double now = moment(model.elements(), model.positions(), model.velocities()).z();
    ASSERT_NEAR(last - now, expected - next, 0.01 * (expected - next)) << "step " << i;
    ASSERT_NEAR(now, next, 0.01 * (inertia * spin.z() - next)) << "all that is lost so far";
    expected = next;
    last = now;
    angle = std::atan(std::sin(angle) / (2 - std::cos(angle)));
  }
  // The limit of small steps, d spin / dt = -h spin^3, from which the first step differs by a half.
  const double limit = spin.z() / std::sqrt(1 + 2 * kDt * kDt * 60 * spin.z() * spin.z());
  EXPECT_NEAR(spin.z() - last / inertia, spin.z() - limit, 0.06 * (spin.z() - limit));
}

}  // namespace
}  // namespace palpate::elasticity
