#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

const Eigen::Vector3d kSize(0.12, 0.06, 0.05);

HexahedralGrid block() { return even_grid(Eigen::Vector3d::Zero(), kSize, {2, 1, 1}); }

/// Shear stress xy on the top face y = 0.06 at x += strain * y.
double shear_stress(NeoHookeanSolid& solid, const HexahedralGrid& grid, double strain, double h) {
  Eigen::Matrix3Xd x = grid.nodes();
  x.row(0) += strain * grid.nodes().row(1);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  solid.add_forces(x, 0 * x, h, forces);
  double force = 0;
  for (const int n : grid.nodes_in({{-1, 0.06, -1}, {1, 0.06, 1}})) force -= forces(0, n);
  return force / (kSize.x() * kSize.z());
}

TEST(MaxwellBranches, StressRelaxesAsTheStandardLinearSolid) {
  const HexahedralGrid grid = block();
  const double g1 = 0.6, g2 = 0.3, tau1 = 0.05, tau2 = 0.4, strain = 1e-4;
  const NeoHookean foam = NeoHookean::from_young(30e3, 0.3);
  NeoHookeanSolid solid(grid, {foam, 0, {{g1, tau1}, {g2, tau2}}});
  const double elastic = foam.shear_modulus * strain;
  EXPECT_NEAR(shear_stress(solid, grid, strain, 0), (1 + g1 + g2) * elastic, 1e-4 * elastic);
  double t = 0;
  for (const double h : {1e-3, 0.02, 0.1, 0.3}) {
    t += h;
    const double expected = 1 + g1 * std::exp(-t / tau1) + g2 * std::exp(-t / tau2);
    EXPECT_NEAR(shear_stress(solid, grid, strain, h), expected * elastic, 1e-4 * elastic);
  }
  EXPECT_NEAR(shear_stress(solid, grid, strain, std::numeric_limits<double>::infinity()), elastic,
              1e-4 * elastic);
}

TEST(MaxwellBranches, EvenStrainRateIsFollowedExactlyAtAnyStep) {
  const HexahedralGrid grid = block();
  const double g = 0.8, tau = 0.1, rate = 1e-4, mu = NeoHookean::from_young(30e3, 0).shear_modulus;
  for (const double h : {0.01, 0.25}) {
    NeoHookeanSolid solid(grid, {NeoHookean::from_young(30e3, 0), 0, {{g, tau}}});
    double stress = 0, t = 0;
    while (t < 0.5 - 1e-9) stress = shear_stress(solid, grid, rate * (t += h), h);
    const double expected = mu * rate * (t + g * tau * (1 - std::exp(-t / tau)));
    EXPECT_NEAR(stress, expected, 1e-4 * expected);
  }
}

TEST(MaxwellBranches, BlockCreepsAsTheStandardLinearSolid) {
  PlantOptions options = small_free_block();
  options.mass_damping = 500;
  const double g = 0.7, tau = 0.1, stress = 30;
  options.maxwell = {{g, tau}};
  TensionRig rig(options);
  rig.pull(stress);
  for (int i = 0; i < 6; ++i) {
    rig.run(0.05);
    const double t = 0.05 * (i + 1);
    const double expected = stress / 30e3 * (1 - g / (1 + g) * std::exp(-t / (tau * (1 + g))));
    EXPECT_NEAR(rig.strain(), expected, 0.01 * expected);
  }
}

TEST(MaxwellBranches, RigidMotionNeedsNoForceAndStoresNothing) {
  const HexahedralGrid grid = block();
  NeoHookeanSolid solid(grid, {NeoHookean::from_young(30e3, 0.3), 0, {{2, 0.1}}, Yield{100, 0}});
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  const Eigen::Matrix3Xd turned = R * grid.nodes();
  solid.add_forces(turned, 0 * turned, 0.01, forces);
  EXPECT_LT(forces.cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_NEAR(solid.energy(turned), 0, 1e-12);
  EXPECT_EQ(solid.greatest_plastic_strain(), 0);
}

TEST(J2Yield, PermanentSetIsThatOfSmallStrainTheory) {
  PlantOptions options = small_free_block();
  options.mass_damping = 1500;
  const double yield = 15, hardening = 10e3, load = 25;
  options.yield = Yield{yield, hardening};
  TensionRig rig(options);
  rig.ramp(0, 0.97 * yield, 0.3);
  EXPECT_EQ(rig.plant.greatest_plastic_strain(), 0);
  rig.ramp(0.97 * yield, load, 0.5);
  rig.run(0.1);
  const double plastic = (load - yield) / hardening;
  EXPECT_NEAR(rig.strain(), load / 30e3 + plastic, 0.01 * rig.strain());
  rig.ramp(load, 0, 0.5);
  rig.run(0.1);
  EXPECT_NEAR(rig.strain(), plastic, 0.01 * plastic);
  std::printf("permanent set / small-strain theory: %.4f\n", rig.strain() / plastic);
  // Compression beyond yield flows in the opposite direction; up to the previous load it is
  // elastic.
  const double strain = rig.plant.greatest_plastic_strain();
  rig.ramp(0, 0.97 * load, 0.3);
  EXPECT_NEAR(rig.plant.greatest_plastic_strain(), strain, 1e-9);
  rig.ramp(0.97 * load, -1.2 * load, 0.8);
  EXPECT_GT(rig.plant.greatest_plastic_strain(), 1.2 * strain);
}

/// Largest von Mises Kirchhoff stress in a homogeneous shear beyond yield.
TEST(J2Yield, ShearStressStopsAtTheYieldStressWhereverItIsTurned) {
  const HexahedralGrid grid = block();
  const double yield = 200;
  NeoHookeanSolid solid(grid, {NeoHookean::from_young(30e3, 0.3), 0, {}, Yield{yield, 0}});
  double stress = 0;
  for (int i = 1; i <= 100; ++i) stress = shear_stress(solid, grid, 4e-4 * i, 0.1);
  EXPECT_NEAR(stress, yield / std::sqrt(3), 0.01 * yield);
  const double shear = 0.04 - stress / NeoHookean::from_young(30e3, 0.3).shear_modulus;
  EXPECT_NEAR(solid.greatest_plastic_strain(), shear / std::sqrt(3), 0.02 * shear);

  // The state is attached to the material: under a rigid rotation, forces rotate with it.
  Eigen::Matrix3Xd x = grid.nodes();
  x.row(0) += 0.04 * grid.nodes().row(1);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Matrix3Xd here = 0 * x, there = 0 * x;
  solid.add_forces(x, 0 * x, 0.1, here);
  solid.add_forces(R * x, 0 * x, 0.1, there);
  EXPECT_LT((there - R * here).cwiseAbs().maxCoeff(), 1e-9 * here.cwiseAbs().maxCoeff());
}

// Past plastic flow bounds the step from then on.
TEST(J2Yield, WhatHasFlowedStaysStiffer) {
  const HexahedralGrid grid = block();
  NeoHookeanSolid solid(grid, {NeoHookean::from_young(30e3, 0.3), 0, {}, Yield{200, 0}});
  Eigen::Matrix3Xd sheared = grid.nodes(), forces = 0 * grid.nodes();
  const double before = solid.add_forces(sheared, 0 * sheared, 0.1, forces);
  sheared.row(0) += 0.3 * grid.nodes().row(1);
  solid.add_forces(sheared, 0 * sheared, 0.1, forces);
  const double flowed = solid.greatest_plastic_strain();
  EXPECT_GT(flowed, 0.1);
  const double first = solid.add_forces(sheared, 0 * sheared, 0.1, forces);
  EXPECT_GT(first, 1.05 * before);
  EXPECT_NEAR(solid.add_forces(sheared, 0 * sheared, 0.1, forces), first, 1e-9);
  EXPECT_NEAR(solid.greatest_plastic_strain(), flowed, 1e-9) << "it was on the yield surface";
}

TEST(J2Yield, ScrambledElementsStayFinite) {
  PlantOptions options = small_free_block();
  options.mass_damping = 20;
  options.viscosity = 0.5;
  options.yield = Yield{100, 0};
  options.maxwell = {{0.5, 0.05}};
  HyperelasticPlant plant(options);
  Eigen::Matrix3Xd scrambled = plant.rest_positions();
  for (int n = 0; n < scrambled.cols(); ++n)  // inverts elements
    scrambled.col(n) += 0.03 * Eigen::Vector3d(std::sin(7 * n), std::sin(11 * n), std::cos(5 * n));
  plant.set_state(scrambled, 0 * scrambled);
  for (int i = 0; i < 1000; ++i) plant.step(1e-3);
  EXPECT_TRUE(plant.positions().allFinite());
  EXPECT_GT(plant.greatest_plastic_strain(), 0.01);
}

TEST(J2Yield, FlowKeepsTheVolume) {
  NeoHookeanSolid solid(block(), {NeoHookean::from_young(30e3, 0.3), 0, {}, Yield{50, 0}});
  Eigen::Matrix3Xd x = block().nodes();
  Eigen::Matrix3Xd forces = 0 * x;
  x = Eigen::Vector3d(1.3, 1 / std::sqrt(1.3), 1 / std::sqrt(1.3)).asDiagonal() * x;
  solid.add_forces(x, 0 * x, 0, forces);
  EXPECT_NEAR(solid.greatest_plastic_strain(), std::log(1.3), 0.01 * std::log(1.3));
  // The remainder is a deviator on the yield surface: no pressure has accumulated.
  EXPECT_NEAR(solid.energy(x), 50 * 50 / (2 * 30e3 / 1.3 * 1.5) * kSize.prod(),
              0.02 * 50 * 50 / (2 * 30e3) * kSize.prod());
}

TEST(ModulusRegion, SeriesOfTwoStiffnessesStretchesAsTheirSum) {
  PlantOptions options = small_free_block();
  options.poisson_ratio = 0;
  options.regions = {{{{0, 0, 0}, {0.05, 0.06, 0.05}}, 120e3}};
  TensionRig rig(options);
  rig.pull(3);
  EXPECT_TRUE(rig.plant.settle(30, 1e-6).converged);
  const double expected = 0.5 * 3 / 30e3 + 0.5 * 3 / 120e3;
  EXPECT_NEAR(rig.strain(), expected, 1e-3 * expected);
  options.regions = {{{{0, 0, 0.2}, {1, 1, 0.3}}, 120e3}};
  EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
}

TEST(Material, RefusesNonsense) {
  const auto refuses = [](auto change) {
    PlantOptions options = small_free_block();
    change(options);
    EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  };
  refuses([](PlantOptions& o) { o.maxwell = {{-0.1, 1}}; });
  refuses([](PlantOptions& o) { o.maxwell = {{0.1, 0}}; });
  refuses([](PlantOptions& o) { o.yield = Yield{0, 0}; });
  refuses([](PlantOptions& o) { o.yield = Yield{1, -1}; });
  refuses([](PlantOptions& o) { o.regions = {{{{0, 0, 0}, {1, 1, 1}}, 0}}; });
}

}  // namespace
}  // namespace palpate::object
