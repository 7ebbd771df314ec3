#include <gtest/gtest.h>

#include "core/solid/strain_energy.hpp"
#include "sim/object/neo_hookean_solid.hpp"
#include "tests/support/solid/strain_energy_tensor.hpp"
#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

/// The fit's Neo-Hookean material equals the plant's, although the implementations are independent.
TEST(FittingMaterial, OneElementHasThePlantsEnergyAndForces) {
  const double E = 30e3, nu = 0.3;
  const Eigen::Vector3d size(0.02, 0.03, 0.05);
  const HexahedralGrid grid = even_grid(Eigen::Vector3d::Zero(), size, {1, 1, 1});
  NeoHookeanSolid solid(grid, {NeoHookean::from_young(E, nu)});
  Eigen::Matrix3d F;
  F << 1.3, 0.2, -0.1, 0.05, 0.8, 0.15, 0.1, -0.2, 1.1;
  const Eigen::Matrix3Xd x = F * grid.nodes();

  const auto material = solid::StrainEnergy::make("neo_hookean");
  support::TensorStress response;
  ASSERT_TRUE(respond_to_gradient(*material, Eigen::Vector2d(E, nu), F, response));
  EXPECT_NEAR(solid.energy(x) / size.prod(), response.energy, 1e-9 * E);

  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, x.cols());
  solid.add_forces(x, 0 * x, 0, forces);
  // The pull on the far side is balanced by the solid's forces.
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d side = Eigen::Vector3d::Zero();
    const double middle = grid.nodes().row(axis).mean();
    for (Eigen::Index n = 0; n < x.cols(); ++n)
      if (grid.nodes()(axis, n) > middle) side += forces.col(n);
    const double area = size.prod() / size[axis];
    EXPECT_LT((side + area * response.stress.col(axis)).norm(), 1e-9 * E * area) << axis;
  }
}

}  // namespace
}  // namespace palpate::object
