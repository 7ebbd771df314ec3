#include "sim/object/neo_hookean_solid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

const NeoHookean kFoam = NeoHookean::from_young(30e3, 0.3);
const Eigen::Vector3d kNeoHookeanSolidSize(0.12, 0.06, 0.05);

HexahedralGrid neo_hookean_solid_block() {
  return even_grid({0.1, -0.2, 0.3}, kNeoHookeanSolidSize, {3, 2, 1});
}

Eigen::Matrix3Xd forces(NeoHookeanSolid solid, const Eigen::Matrix3Xd& positions,
                        const Eigen::Matrix3Xd& velocities) {
  Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, positions.cols());
  solid.add_forces(positions, velocities, 0, f);
  return f;
}

Eigen::Matrix3Xd forces(NeoHookeanSolid solid, const Eigen::Matrix3Xd& positions) {
  return forces(solid, positions, 0 * positions);
}

Eigen::Matrix3Xd random_field(Eigen::Index n, double size) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-size, size);
  Eigen::Matrix3Xd field(3, n);
  for (double& value : field.reshaped()) value = uniform(generator);
  return field;
}

TEST(NeoHookeanSolid, RigidMotionNeedsNoForce) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid solid(grid, {kFoam, 2.0});
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd moved = (R * grid.nodes()).colwise() + Eigen::Vector3d(1, 2, 3);
  Eigen::Matrix3Xd spinning = moved;
  for (auto column : spinning.colwise()) {
    const Eigen::Vector3d p = column;
    column = Eigen::Vector3d(4, 5, -6).cross(p);
  }
  EXPECT_LT(forces(solid, grid.nodes()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(forces(solid, moved, spinning).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(solid.energy(moved), 0, 1e-12);
}

TEST(NeoHookeanSolid, ForceIsMinusTheDerivativeOfTheEnergy) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid solid(grid, {kFoam, 0});
  // The larger perturbation inverts elements, beyond the guard of the logarithm.
  for (const double size : {0.002, 0.03}) {
    const Eigen::Matrix3Xd x = grid.nodes() + random_field(grid.node_count(), size);
    const Eigen::Matrix3Xd f = forces(solid, x);
    const double scale = f.cwiseAbs().maxCoeff();
    ASSERT_TRUE(f.allFinite());
    for (int n = 0; n < grid.node_count(); n += 7) {
      for (int axis = 0; axis < 3; ++axis) {
        const double h = 1e-7;
        Eigen::Matrix3Xd ahead = x, behind = x;
        ahead(axis, n) += h;
        behind(axis, n) -= h;
        const double slope = (solid.energy(ahead) - solid.energy(behind)) / (2 * h);
        EXPECT_NEAR(f(axis, n), -slope, 2e-6 * scale) << size << " node " << n;
      }
    }
    EXPECT_LT(f.rowwise().sum().norm(), 1e-10 * scale);
  }
}

TEST(NeoHookeanSolid, ElementsDoNotMindTheirNeighboursInAPack) {
  // Three elements in a row load their nodes like each of them alone.
  const Eigen::Vector3d side(0.04, 0.06, 0.05);
  const HexahedralGrid row = even_grid(Eigen::Vector3d::Zero(), {0.12, 0.06, 0.05}, {3, 1, 1});
  const Eigen::Matrix3Xd x = row.nodes() + random_field(row.node_count(), 0.003);
  const Eigen::Matrix3Xd together = forces(NeoHookeanSolid(row, {kFoam, 0}), x);
  Eigen::Matrix3Xd apart = 0 * together;
  double energy = 0;
  for (int e = 0; e < 3; ++e) {
    const HexahedralGrid one = even_grid({0.04 * e, 0, 0}, side, {1, 1, 1});
    Eigen::Matrix3Xd corners(3, 27);
    for (int a = 0; a < 27; ++a) corners.col(one.elements()(a, 0)) = x.col(row.elements()(a, e));
    const NeoHookeanSolid solid(one, {kFoam, 0});
    const Eigen::Matrix3Xd f = forces(solid, corners);
    for (int a = 0; a < 27; ++a) apart.col(row.elements()(a, e)) += f.col(one.elements()(a, 0));
    energy += solid.energy(corners);
  }
  EXPECT_LT((together - apart).cwiseAbs().maxCoeff(), 1e-13 * together.cwiseAbs().maxCoeff());
  EXPECT_NEAR(NeoHookeanSolid(row, {kFoam, 0}).energy(x), energy, 1e-13 * energy);
}

TEST(NeoHookeanSolid, PatchTestHomogeneousStrainLoadsTheSurfaceOnly) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid solid(grid, {kFoam, 0});
  Eigen::Matrix3d F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.15, 0.1, -0.03, 1.1;
  const Eigen::Matrix3Xd f = forces(solid, F * grid.nodes());
  const Box interior{Eigen::Vector3d(0.1001, -0.1999, 0.3001),
                     Eigen::Vector3d(0.2199, -0.1401, 0.3499)};
  const auto inside = grid.nodes_in(interior);
  ASSERT_FALSE(inside.empty());
  for (const int n : inside) EXPECT_LT(f.col(n).norm(), 1e-12 * f.cwiseAbs().maxCoeff() + 1e-13);
  const double J = F.determinant();
  const double volume = kNeoHookeanSolidSize.prod();
  const double density = 0.5 * kFoam.shear_modulus * (F.squaredNorm() - 3) -
                         kFoam.shear_modulus * std::log(J) +
                         0.5 * kFoam.lame * std::log(J) * std::log(J);
  EXPECT_NEAR(solid.energy(F * grid.nodes()), volume * density, 1e-12 * volume * density);
}

TEST(NeoHookeanSolid, UniaxialStressFollowsTheClosedForm) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid solid(grid, {kFoam, 0});
  const double mu = kFoam.shear_modulus;
  const double lambda = kFoam.lame;
  for (const double s : {0.6, 0.9, 1.3, 2.0}) {
    // Lateral stretch t with mu (t^2 - 1) + lambda ln(s t^2) = 0, by Newton's method.
    double t = 1;
    for (int i = 0; i < 50; ++i) {
      t -= (mu * (t * t - 1) + lambda * std::log(s * t * t)) / (2 * mu * t + 2 * lambda / t);
    }
    const double stress = mu * (s - 1 / s) + lambda * std::log(s * t * t) / s;
    const Eigen::Matrix3Xd f = forces(solid, Eigen::Vector3d(s, t, t).asDiagonal() * grid.nodes());
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    const double end = 0.1 + kNeoHookeanSolidSize.x();
    for (const int n : grid.nodes_in({{end, -9, -9}, {end, 9, 9}})) pull -= f.col(n);
    EXPECT_NEAR(pull.x(), stress * kNeoHookeanSolidSize.y() * kNeoHookeanSolidSize.z(),
                1e-10 * std::abs(pull.x()));
    EXPECT_LT(f.bottomRows<2>().cwiseAbs().maxCoeff(), 1e-10 * std::abs(pull.x()));
  }
}

TEST(NeoHookeanSolid, SmallStrainModulusIsYoungs) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid solid(grid, {kFoam, 0});
  const double strain = 1e-6;
  const Eigen::Vector3d stretch(1 + strain, 1 - 0.3 * strain, 1 - 0.3 * strain);
  const double energy = solid.energy(stretch.asDiagonal() * grid.nodes());
  EXPECT_NEAR(energy, 0.5 * 30e3 * strain * strain * kNeoHookeanSolidSize.prod(), 1e-3 * energy);
}

TEST(NeoHookeanSolid, ViscosityTakesEnergyOut) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  const NeoHookeanSolid elastic(grid, {kFoam, 0});
  const NeoHookeanSolid viscous(grid, {kFoam, 3.0});
  const Eigen::Matrix3Xd x = grid.nodes() + random_field(grid.node_count(), 0.002);
  // Shear at rate g: power eta g^2 per volume (dC/dt = g (e1 e2' + e2 e1') at rest).
  Eigen::Matrix3Xd shearing = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  shearing.row(0) = 2.0 * grid.nodes().row(1);
  const double power = forces(viscous, grid.nodes(), shearing).cwiseProduct(shearing).sum();
  EXPECT_NEAR(power, -3.0 * 4.0 * kNeoHookeanSolidSize.prod(), 1e-9);
  const Eigen::Matrix3Xd v = random_field(grid.node_count(), 0.5);
  EXPECT_LT((forces(viscous, x, v) - forces(elastic, x, v)).cwiseProduct(v).sum(), 0);
}

TEST(NeoHookeanSolid, StiffeningMatchesTheTangentOfASqueezedBlock) {
  const HexahedralGrid grid = neo_hookean_solid_block();
  NeoHookeanSolid solid(grid, {kFoam, 0});
  Eigen::Matrix3Xd scratch = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  const double s = 0.6;
  Eigen::Matrix3Xd x = grid.nodes();
  x.row(0) *= s;
  const double stiffening = solid.add_forces(x, 0 * x, 0, scratch);
  // d2 Psi / ds2 for F = diag(s, 1, 1).
  const double psi[3] = {solid.energy(Eigen::Vector3d(s - 1e-4, 1, 1).asDiagonal() * grid.nodes()),
                         solid.energy(x),
                         solid.energy(Eigen::Vector3d(s + 1e-4, 1, 1).asDiagonal() * grid.nodes())};
  const double modulus = (psi[0] - 2 * psi[1] + psi[2]) / 1e-8 / kNeoHookeanSolidSize.prod();
  EXPECT_NEAR(stiffening, modulus / (2 * kFoam.shear_modulus + kFoam.lame), 1e-4);
  EXPECT_NEAR(solid.add_forces(grid.nodes(), 0 * x, 0, scratch), 1, 1e-12);
}

}  // namespace
}  // namespace palpate::object
