#include "sim/sensors/biotac_skin.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::sensors {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using sensing::ElectrodeVector;

constexpr double kPi = 3.14159265358979323846;

Touch press(const Vector3d& at, double newton, double radius = 3e-3) {
  const Vector3d location = sensing::project_on_skin(at);
  return {location, -newton * sensing::skin_normal(location), radius};
}

TEST(BiotacFilm, CoversHalfACylinderAndAQuarterOfASphere) {
  const BiotacFilm& film = biotac_film();
  const double r = sensing::kSkinRadius;
  EXPECT_NEAR(film.areas.sum(), kPi * r * 16e-3 + kPi * r * r, 5e-6);
  for (Eigen::Index p = 0; p < film.points.cols(); ++p)
    EXPECT_LT((sensing::project_on_skin(film.points.col(p)) - film.points.col(p)).norm(), 1e-9);
}

TEST(BiotacFilm, CurrentFlowsFromEachElectrodeByItself) {
  const BiotacFilm& film = biotac_film();
  for (int i = 0; i < sensing::kElectrodeCount; ++i) {
    EXPECT_NEAR(film.shares.row(i).sum(), 1, 1e-12);
    EXPECT_GE(film.shares.row(i).minCoeff(), 0);
    // The point of highest current density, at the electrode or at the excitation electrode, is
    // closer to it than the pad's length.
    Eigen::Index most = 0;
    film.shares.row(i).maxCoeff(&most);
    const Vector3d at = sensing::project_on_skin(sensing::electrode_positions().col(i));
    EXPECT_LT((film.points.col(most) - at).norm(), 6e-3) << "E" << i + 1;
  }
  // The pad is symmetric, and so is the current: E1 and E11, E4 and E14.
  for (const auto& [left, right] : {std::pair{0, 10}, {3, 13}, {5, 15}})
    for (Eigen::Index p = 0; p < film.points.cols(); ++p)
      EXPECT_NEAR(film.shares(left, p), film.shares(right, (p / 11) * 11 + 10 - p % 11), 2e-3);
}

TEST(BiotacSkin, FluidThatStaysBelowThePadKeepsItsVolume) {
  SkinTable table;
  table.bulge = 1;
  const VectorXd dent = BiotacSkin(table).equilibrium({press({-7e-3, 2e-3, -7e-3}, 1)});
  const VectorXd& areas = biotac_film().areas;
  EXPECT_GT(dent.maxCoeff(), 1e-4);
  EXPECT_LT(std::abs(dent.dot(areas)), 1e-12 * dent.cwiseAbs().dot(areas) + 1e-18);
  table.bulge = 0;
  EXPECT_GT(BiotacSkin(table).equilibrium({press({-7e-3, 2e-3, -7e-3}, 1)}).dot(areas), 1e-9);
}

// A wide, light contact: foundation times volume is the force.
TEST(BiotacSkin, FoundationCarriesTheForce) {
  SkinTable table;
  table.bulge = 0;
  const double force = 0.05;
  const VectorXd dent = BiotacSkin(table).equilibrium({press({-8e-3, 0, -7e-3}, force)});
  EXPECT_NEAR(table.foundation * dent.dot(biotac_film().areas), force, 0.1 * force);
}

TEST(BiotacSkin, LagsByFrictionAtAnyPaceAndByCreepWhenQuick) {
  const auto loop = [](const SkinTable& table, double period) {
    BiotacSkin skin(table);
    double area = 0, before_force = 0, before = 0;
    const int steps = 400;
    for (int k = 1; k <= 2 * steps; ++k) {
      const double force = 0.5 * (1 - std::cos(2 * kPi * k / steps));
      skin.step(period / steps, {press({-7e-3, 0, -7e-3}, force)});
      const double value = skin.resistance()[16];
      if (k > steps) area += 0.5 * (value + before) * (force - before_force);
      before = value;
      before_force = force;
    }
    return area;
  };
  SkinTable elastic;
  EXPECT_NEAR(loop(elastic, 1), 0, 1e-6);
  SkinTable friction;
  friction.friction = 5e-6;
  EXPECT_LT(loop(friction, 1), -1e-3) << "the way down lies above the way up";
  EXPECT_NEAR(loop(friction, 1), loop(friction, 100), 1e-6);
  SkinTable creep;
  creep.slow_share = 0.2;
  creep.slow_time = 1;
  EXPECT_LT(loop(creep, 2 * kPi), 5 * loop(creep, 1000));
  EXPECT_LT(loop(creep, 2 * kPi), -1e-3);
}

TEST(PressingForce, IsWhatPressesAndNothingThatPulls) {
  Touch touch = press({-7e-3, 0, -7e-3}, 2);
  EXPECT_NEAR(pressing_force({touch}), 2, 1e-12);
  touch.force_T += Vector3d(1, 1, 0);
  EXPECT_NEAR(pressing_force({touch}), 2, 1e-12);
  touch.force_T = Vector3d(0, 0, -3);
  EXPECT_EQ(pressing_force({touch}), 0);
}

}  // namespace
}  // namespace palpate::sensors
