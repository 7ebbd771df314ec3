#include "core/solid/solid_solver.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/static_solver.hpp"
#include "core/math/random.hpp"
#include "core/math/rigid.hpp"
#include "core/mesh/grid_mesh.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

const Vector3d kSolidSolverBar(0.1, 0.03, 0.02);

mesh::ElementMesh bar(const std::array<int, 3>& cells) {
  return mesh::make_element_mesh(mesh::make_box(kSolidSolverBar, cells),
                                 mesh::ElementOrder::kQuadratic);
}

Matrix3Xd shaken(const Matrix3Xd& nodes, double by) {
  Matrix3Xd x = nodes;
  for (int i = 0; i < x.size(); ++i) x.data()[i] += by * std::sin(12.9898 * (i + 1) + 0.3);
  return x;
}

SolidCoefficients rubber(double nu = 0.49) {
  return make_solid_material(2e5, nu, 0.3, 0.2).coefficients;
}

double relative(const Matrix3Xd& a, const Matrix3Xd& b) { return (a - b).norm() / b.norm(); }

TEST(SolidSolver, ForcesAreTheGradientOfTheEnergyAndTangentTheirs) {
  const SolidBody body(bar({2, 1, 1}), elasticity::nodes_at(bar({2, 1, 1}), 0, 0));
  SolidSolver solver(body);
  const Matrix3Xd x = shaken(body.mesh().nodes, 4e-4);
  const Matrix3Xd direction = shaken(0 * x, 1);
  const double h = 1e-7;
  Matrix3Xd f, ahead, behind, product(3, x.cols());
  body.elements().forces(x, rubber(), f);
  const double up = body.elements().forces(x + h * direction, rubber(), ahead);
  const double down = body.elements().forces(x - h * direction, rubber(), behind);
  EXPECT_NEAR((up - down) / (2 * h) / (f.array() * direction.array()).sum(), 1, 1e-7);
  // Over free nodes only, as the matrix is.
  Matrix3Xd free = direction;
  solver.clear_fixed(free);
  body.elements().forces(x + h * free, rubber(), ahead);
  body.elements().forces(x - h * free, rubber(), behind);
  Matrix3Xd slope = (ahead - behind) / (2 * h);
  solver.clear_fixed(slope);
  solver.tangent(x, rubber()).multiply(free, product);
  EXPECT_LT(relative(product, slope), 1e-7);
}

TEST(SolidSolver, RigidMotionGivesNoForceAndTurnsForces) {
  const mesh::ElementMesh mesh = bar({2, 1, 1});
  const SolidElements elements(mesh);
  const Matrix3d R = math::exp_rotation({1, -2, 0.5});
  const Vector3d t(3, 4, -5);
  Matrix3Xd f, turned;
  elements.forces(((R * mesh.nodes).colwise() + t).eval(), rubber(), f);
  EXPECT_LT(f.cwiseAbs().maxCoeff(), 1e-9);
  const Matrix3Xd x = shaken(mesh.nodes, 4e-4);
  elements.forces(x, rubber(), f);
  elements.forces(((R * x).colwise() + t).eval(), rubber(), turned);
  EXPECT_LT(relative(turned, R * f), 1e-10);
  Vector3d torque = Vector3d::Zero();
  for (int i = 0; i < x.cols(); ++i) torque += x.col(i).cross(f.col(i));
  EXPECT_LT(f.rowwise().sum().norm(), 1e-12 * f.norm());
  EXPECT_LT(torque.norm(), 1e-12 * f.norm());
}

/// If the surface is moved by one deformation gradient, the interior must follow it, at large
/// strain.
TEST(SolidSolver, PassesThePatchTest) {
  mesh::TetrahedralMesh corners = mesh::make_box(kSolidSolverBar, {3, 3, 3});
  std::vector<int> surface;
  for (int i = 0; i < corners.nodes.cols(); ++i) {
    const Vector3d p = corners.nodes.col(i);
    const bool inside = (p.array() > 1e-9).all() && ((kSolidSolverBar - p).array() > 1e-9).all();
    if (inside) corners.nodes.col(i) += 2e-3 * Vector3d(std::sin(7. * i), std::cos(5. * i), 0.4);
  }
  const mesh::ElementMesh mesh = mesh::make_element_mesh(corners, mesh::ElementOrder::kQuadratic);
  for (int i = 0; i < mesh.node_count(); ++i) {
    const Vector3d p = mesh.nodes.col(i);
    if (!((p.array() > 1e-9).all() && ((kSolidSolverBar - p).array() > 1e-9).all()))
      surface.push_back(i);
  }
  const SolidBody body(mesh, surface);
  SolidSolver solver(body);
  const Matrix3d F = (Matrix3d() << 1.2, 0.2, 0, -0.1, 0.9, 0.1, 0, 0.1, 0.95).finished();
  Matrix3Xd x = F * mesh.nodes;
  for (int i = 0; i < x.cols(); ++i) {
    if (body.pattern().unknown(i) >= 0) x.col(i) += 3e-4 * Vector3d(std::sin(3. * i), 0.5, -0.2);
  }
  ASSERT_TRUE(solver.solve(rubber(), Matrix3Xd::Zero(3, x.cols()), x));
  EXPECT_LT((x - F * mesh.nodes).cwiseAbs().maxCoeff(), 1e-9 * kSolidSolverBar.x());
}

/// Sag of the bar's end under a small load, relative to Timoshenko's beam.
double sag_ratio(const std::array<int, 3>& cells, double nu) {
  const double E = 2e5, force = 1e-4;
  const SolidBody body(bar(cells), elasticity::nodes_at(bar(cells), 0, 0));
  SolidSolver solver(body);
  Matrix3Xd x = body.mesh().nodes;
  const Matrix3Xd load = elasticity::face_load(body.mesh(), kSolidSolverBar.x(), {0, 0, -force});
  EXPECT_TRUE(solver.solve(make_solid_material(E, nu).coefficients, load, x));
  const double area = kSolidSolverBar.y() * kSolidSolverBar.z(),
               inertia = area * kSolidSolverBar.z() * kSolidSolverBar.z() / 12;
  const double bending = force * std::pow(kSolidSolverBar.x(), 3) / (3 * E * inertia);
  const double shear = force * kSolidSolverBar.x() / (5.0 / 6 * area * E / (2 * (1 + nu)));
  return -elasticity::face_displacement(body.mesh(), kSolidSolverBar.x(), x).z() /
         (bending + shear);
}

/// The clamp prevents the section from contracting, which stiffens this short bar by some percent
/// as nu grows; locking would stiffen it without bound, and more on coarser meshes.
TEST(SolidSolver, DoesNotLockTowardsIncompressibility) {
  EXPECT_NEAR(sag_ratio({9, 3, 3}, 0.3), 1, 0.02);
  double last = 0;
  for (double nu : {0.3, 0.49, 0.499, 0.4999}) {
    const double coarse = sag_ratio({6, 2, 2}, nu), fine = sag_ratio({9, 3, 3}, nu);
    EXPECT_NEAR(coarse / fine, 1, 0.015) << nu;
    EXPECT_GT(fine, 0.92) << nu;
    if (nu > 0.499) {
      EXPECT_NEAR(fine / last, 1, 0.002);
    }
    last = fine;
  }
}

TEST(SolidSolver, SensitivitiesMatchCentralDifferences) {
  const double E = 5e4, nu = 0.48, density = 1000;
  const SolidBody body(bar({4, 1, 1}), elasticity::nodes_at(bar({4, 1, 1}), 0, 0));
  SolidSolver solver(body);
  const Matrix3Xd unit_weight = Vector3d(0, 0, -9.81) * body.nodal_volume().transpose();
  const Matrix3Xd tip = elasticity::face_load(body.mesh(), kSolidSolverBar.x(), {0, 0, -0.05});
  const auto solved = [&](double young, double poisson, double rho) {
    Matrix3Xd x = body.mesh().nodes;
    SolidOptions options;
    options.tolerance = 1e-12;
    EXPECT_TRUE(solver.solve(make_solid_material(young, poisson).coefficients,
                             tip + rho * unit_weight, x, options));
    return x;
  };
  const SolidMaterial m = make_solid_material(E, nu);
  const Matrix3Xd x = solved(E, nu, density);
  ASSERT_GT((x - body.mesh().nodes).cwiseAbs().maxCoeff(),
            0.2 * kSolidSolverBar.x());  // large deflection
  SolidSlope by_young, by_poisson, by_density;
  by_young.coefficients = m.by_young;
  by_poisson.coefficients = m.by_poisson;
  by_density.load = unit_weight;
  const Matrix3Xd dE = solver.sensitivity(x, by_young), dnu = solver.sensitivity(x, by_poisson),
                  drho = solver.sensitivity(x, by_density);
  const double h = 1e-4;
  const auto central = [&](double e, double n, double r) {
    return ((solved(E + e, nu + n, density + r) - solved(E - e, nu - n, density - r)) / 2).eval();
  };
  EXPECT_LT(relative(dE, central(h * E, 0, 0) / (h * E)), 1e-6);
  EXPECT_LT(relative(dnu, central(0, 1e-5, 0) / 1e-5), 1e-6);
  EXPECT_LT(relative(drho, central(0, 0, h * density) / (h * density)), 1e-6);
}

/// Largest distance of a node from where the loop's elements put it on a bent bar, relative to the
/// largest displacement.
double distance_from_loop(const std::array<int, 3>& cells, double share) {
  const double E = 5e4, nu = 0.3;
  elasticity::Body loop =
      elasticity::make_bar(kSolidSolverBar, cells, mesh::ElementOrder::kQuadratic, {E, nu, 1});
  loop.law = elasticity::find_stretch_law("mooney_rivlin")->make({share});
  const Matrix3Xd load =
      elasticity::face_load(loop.mesh, kSolidSolverBar.x(), Vector3d(0, 0.02, -0.1));
  const auto found = elasticity::solve_static(loop, load);
  EXPECT_TRUE(found.converged);
  const SolidBody body(loop.mesh, loop.fixed_nodes);
  SolidSolver solver(body);
  Matrix3Xd x = loop.mesh.nodes;
  EXPECT_TRUE(solver.solve(make_solid_material(E, nu, share).coefficients, load, x));
  const double moved = (x - loop.mesh.nodes).colwise().norm().maxCoeff();
  EXPECT_GT(moved, 0.3 * kSolidSolverBar.x());
  return (x - found.positions).colwise().norm().maxCoeff() / moved;
}

/// They hold the volume at each point, these in the mean over an element; both converge to the same
/// shape with the square of the mesh size (0.7 % at 16 x 4 x 4 cells).
TEST(SolidSolver, ConvergesToTheShapeOfTheLoopsHyperelasticElements) {
  for (const double share : {0.0, 0.4}) {
    const double coarse = distance_from_loop({4, 1, 1}, share),
                 fine = distance_from_loop({8, 2, 2}, share);
    EXPECT_LT(fine, 0.03) << share;
    EXPECT_LT(fine, 0.3 * coarse) << share;
  }
}

TEST(SolidSolver, RefusesWhatItCannotSolve) {
  EXPECT_THROW(SolidBody(bar({2, 1, 1}), {}), std::invalid_argument);
  const mesh::ElementMesh linear = mesh::make_element_mesh(
      mesh::make_box(kSolidSolverBar, {2, 1, 1}), mesh::ElementOrder::kLinear);
  EXPECT_THROW(SolidElements{linear}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::solid
