#include "sim/scenes/soft_box_plant.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kEdge = 0.06, kRadius = 7e-3;  // m

robot::SoftBoxOptions small_box() {
  robot::SoftBoxOptions options;
  options.size.setConstant(kEdge);
  options.vertices = {4, 4, 4};
  options.mass = 0.01;
  return options;
}

std::unique_ptr<SoftBoxPlant> rested() {
  const std::vector<object::FingertipOptions> tips(1, {kRadius, 0, 0, 0.8});
  auto plant = std::make_unique<SoftBoxPlant>(small_box(), tips);
  plant->move_fingertip(0, {0.03, 0.03, kEdge + kRadius + 2e-3}, {});
  plant->settle();
  return plant;
}

/// Moves the tip at 20 mm/s along z.
void move(SoftBoxPlant& plant, double way) {
  const int steps = static_cast<int>(std::abs(way) / 20e-6);
  for (int i = 0; i < steps; ++i) {
    const Vector3d goal = plant.fingertip_centre(0) + Vector3d(0, 0, way / steps);
    plant.move_fingertip(0, goal, {});
    plant.step(1e-3);
    ASSERT_LT((plant.fingertip_centre(0) - goal).norm(), 1e-9);
  }
}

TEST(SoftBoxPlant, DentsUnderAFingertipAndComesBack) {
  const auto rested_plant = rested();
  SoftBoxPlant& plant = *rested_plant;
  const Eigen::Matrix3Xd rest = plant.positions();
  EXPECT_FALSE(plant.touch(0).touching);
  move(plant, -6e-3);
  ASSERT_TRUE(plant.positions().allFinite());
  const object::FingertipTouch& touch = plant.touch(0);
  ASSERT_TRUE(touch.touching);
  EXPECT_GT(touch.force.z(), 0.02) << "N, up on the tip";
  EXPECT_GT(touch.normal.z(), 0.9);
  EXPECT_LT((plant.fingertip_centre(0) - touch.point).norm(), 1.05 * kRadius);
  EXPECT_GT(touch.depth, 0);
  EXPECT_LT((rest - plant.positions()).row(2).minCoeff(), 1e-4) << "bulges nowhere much";
  EXPECT_GT((rest - plant.positions()).row(2).maxCoeff(), 5e-4) << "m, dented";
  EXPECT_EQ(plant.fingertip_wrench(0).force, touch.force);
  move(plant, 10e-3);
  for (int i = 0; i < 400; ++i) plant.step(1e-3);
  EXPECT_FALSE(plant.touch(0).touching);
  EXPECT_LT((plant.positions() - rest).colwise().norm().maxCoeff(), 5e-5);
}

TEST(SoftBoxPlant, TwoRunsAreEqualToTheBit) {
  const auto run_once = [] {
    const auto rested_plant = rested();
    SoftBoxPlant& plant = *rested_plant;
    move(plant, -4e-3);
    return Eigen::Matrix3Xd(plant.positions());
  };
  EXPECT_EQ(run_once(), run_once());
}

TEST(SoftBoxPlant, ItsTetrahedraFillTheBox) {
  const auto rested_plant = rested();
  const SoftBoxPlant& plant = *rested_plant;
  const Eigen::Matrix3Xd& x = plant.rest_positions();
  double volume = 0;
  for (int e = 0; e < plant.elements().cols(); ++e) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i)
      edges.col(i) = x.col(plant.elements()(i + 1, e)) - x.col(plant.elements()(0, e));
    EXPECT_GT(edges.determinant(), 0) << e;
    volume += edges.determinant() / 6;
  }
  EXPECT_NEAR(volume, kEdge * kEdge * kEdge, 1e-9);
}

TEST(SoftBoxPlant, APokePushesTheNearestVertex) {
  const auto rested_plant = rested();
  SoftBoxPlant& plant = *rested_plant;
  const Eigen::Matrix3Xd rest = plant.positions();
  plant.push({0.061, 0.021, 0.019}, {-0.1, 0, 0});
  for (int i = 0; i < 300; ++i) plant.step(1e-3);
  int furthest = 0;
  (plant.positions() - rest).colwise().norm().maxCoeff(&furthest);
  EXPECT_LT((plant.rest_positions().col(furthest) - Vector3d(0.06, 0.02, 0.02)).norm(), 1e-3);
  EXPECT_LT((plant.positions() - rest)(0, furthest), -5e-4);
  plant.clear_forces();
  for (int i = 0; i < 500; ++i) plant.step(1e-3);
  EXPECT_LT((plant.positions() - rest).colwise().norm().maxCoeff(), 5e-5);
}

}  // namespace
}  // namespace palpate::scenes
