#include "core/elasticity/static_solver.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// A slender quadratic cantilever against Timoshenko's beam: F L^3 / 3 E I + F L / k G A.
TEST(LinearStatics, QuadraticCantileverBendsAsTimoshenkoSays) {
  const double L = 0.4, a = 0.04, E = 2e5, nu = 0.0, force = 0.01;
  Body body = make_bar({L, a, a}, {12, 2, 2}, mesh::ElementOrder::kQuadratic, {E, nu, 100});
  const Matrix3Xd u = solve_linear_statics(body, face_load(body.mesh, L, Vector3d(0, 0, -force)));
  const double inertia = std::pow(a, 4) / 12, shear = E / (2 * (1 + nu)) * a * a * 5 / 6;
  const double expected = force * std::pow(L, 3) / (3 * E * inertia) + force * L / shear;
  const Vector3d tip = face_displacement(body.mesh, L, body.mesh.nodes + u);
  EXPECT_NEAR(-tip.z(), expected, 0.01 * expected);
  EXPECT_NEAR(tip.y(), 0, 1e-3 * expected);
}

TEST(LinearStatics, LinearTetrahedraAreStiffer) {
  const auto tip = [](mesh::ElementOrder order) {
    Body body = make_bar({0.2, 0.05, 0.05}, {6, 2, 2}, order);
    const Matrix3Xd u = solve_linear_statics(body, face_load(body.mesh, 0.2, Vector3d(0, 0, -0.1)));
    return -face_displacement(body.mesh, 0.2, body.mesh.nodes + u).z();
  };
  EXPECT_LT(tip(mesh::ElementOrder::kLinear), 0.7 * tip(mesh::ElementOrder::kQuadratic));
}

// Stretching of a bar without lateral contraction is exact for any mesh: u = F L / E A.
TEST(LinearStatics, StretchedBar) {
  Body body = make_bar({0.3, 0.02, 0.03}, {4, 1, 2}, mesh::ElementOrder::kLinear, {1e5, 0, 100});
  const Matrix3Xd u = solve_linear_statics(body, face_load(body.mesh, 0.3, Vector3d(0.5, 0, 0)));
  const double expected = 0.5 * 0.3 / (1e5 * 0.02 * 0.03);
  for (int i : nodes_at(body.mesh, 0, 0.3)) EXPECT_NEAR(u(0, i), expected, 1e-9 * expected);
}

TEST(LinearStatics, WithoutSupportItThrows) {
  Body body = make_bar({0.2, 0.05, 0.05}, {2, 1, 1}, mesh::ElementOrder::kLinear);
  body.fixed_nodes.clear();
  EXPECT_THROW(solve_linear_statics(body, Matrix3Xd::Zero(3, body.mesh.node_count())),
               std::runtime_error);
}

// Under its own weight a column shortens by rho g L^2 / 2 E to first order (nu = 0).
TEST(StaticSolver, ColumnUnderItsOwnWeight) {
  Body body = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kQuadratic, {1e6, 0, 100});
  body.gravity_O = Vector3d(-9.81, 0, 0);
  const StaticSolution s = solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()));
  ASSERT_TRUE(s.converged);
  const double expected = 100 * 9.81 * 0.2 * 0.2 / (2 * 1e6);
  const Vector3d tip = face_displacement(body.mesh, 0.2, s.positions);
  EXPECT_NEAR(-tip.x(), expected, 1e-3 * expected);
  const double weight = 100 * 9.81 * 0.2 * 0.05 * 0.05;
  EXPECT_NEAR(s.reactions.row(0).sum(), weight, 1e-8 * weight);
}

// Both ends of the bar rotate equally: no strain, no force.
TEST(StaticSolver, AHandThatMovesWithTheBodyFeelsNothing) {
  Body body = make_bar({0.2, 0.05, 0.05}, {3, 1, 1}, mesh::ElementOrder::kQuadratic);
  GraspRegion other;
  other.nodes = body.fixed_nodes;
  body.fixed_nodes.clear();
  body.grasps.push_back(other);
  const math::Pose X = math::make_pose(rotation(2.5, {1, 2, -1}), Vector3d(0.3, -0.1, 0.2));
  const StaticSolution s = solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()),
                                        {X * body.grasps[0].X_OG_rest, X * other.X_OG_rest});
  ASSERT_TRUE(s.converged);
  EXPECT_LT((s.positions - X * body.mesh.nodes).norm(), 1e-9);
  EXPECT_LT(s.reactions.cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace palpate::elasticity
