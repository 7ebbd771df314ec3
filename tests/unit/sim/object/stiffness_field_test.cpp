#include "sim/object/stiffness_field.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

using Eigen::Vector3d;

TEST(StiffnessField, HasTheMeanDeviationAndCorrelationThatWereAskedFor) {
  // Over seeds, at points that are 0, 1 and 2 correlation lengths apart.
  constexpr double kDeviation = 0.4, kLength = 0.08;
  constexpr int kSeeds = 3000;
  Eigen::Matrix<double, 3, Eigen::Dynamic> logs(3, kSeeds);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const StiffnessField field({kDeviation, kLength, static_cast<std::uint64_t>(seed)});
    for (int i = 0; i < 3; ++i)
      logs(i, seed) = std::log(field.factor({0.1, 0.02 + 0.6 * kLength * i, 0.8 * kLength * i}));
  }
  EXPECT_LE(logs.cwiseAbs().maxCoeff(), 2 * kDeviation * (1 + 1e-12));
  EXPECT_GT(logs.cwiseAbs().maxCoeff(), 1.99 * kDeviation);
  const Vector3d mean = logs.rowwise().mean();
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 4 * kDeviation / std::sqrt(kSeeds));
  const Eigen::Matrix3d covariance = logs * logs.transpose() / kSeeds;
  // A normal distribution held within two deviations: E[min(|z|, 2)^2] = 0.9205.
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(covariance(i, i), 0.9205 * kDeviation * kDeviation, 0.1 * kDeviation * kDeviation);
  EXPECT_NEAR(covariance(0, 1) / covariance(0, 0), std::exp(-0.5), 0.06);
  EXPECT_NEAR(covariance(0, 2) / covariance(0, 0), std::exp(-2.0), 0.06);
}

TEST(StiffnessField, IsThatOfItsSeed) {
  const StiffnessField one({0.3, 0.1, 7}), same({0.3, 0.1, 7}), other({0.3, 0.1, 8});
  const Vector3d p(0.2, 0.01, 0.03);
  EXPECT_EQ(one.factor(p), same.factor(p));
  EXPECT_NE(one.factor(p), other.factor(p));
  EXPECT_NEAR(one.factor(p), one.factor(p + Vector3d::Constant(1e-6)), 1e-4);  // smooth
}

PlantOptions block(double deviation) {
  PlantOptions options = small_free_block();
  options.elements = {4, 2, 2};
  options.stiffness_field = {deviation, 0.04, 3};
  return options;
}

TEST(StiffnessField, ScalesTheEnergyOfTheSolidPointByPoint) {
  const PlantOptions options = block(0.5);
  HyperelasticPlant varied(options), uniform(block(0));
  const Eigen::Matrix3Xd stretched = Vector3d(1.1, 1, 0.95).asDiagonal() * varied.rest_positions();
  varied.set_state(stretched, 0 * stretched);
  uniform.set_state(stretched, 0 * stretched);
  // Under a uniform strain the energy is that of the mean modulus.
  const StiffnessField field(options.stiffness_field);
  double mean = 0;
  constexpr int kCount = 20;
  for (int i = 0; i < kCount * kCount * kCount; ++i) {
    const Eigen::Array3d at(i % kCount, i / kCount % kCount, i / kCount / kCount);
    mean += field.factor(((at + 0.5) / kCount * options.size.array()).matrix());
  }
  mean /= kCount * kCount * kCount;
  EXPECT_GT(std::abs(mean - 1), 0.02);
  EXPECT_NEAR(varied.elastic_energy() / uniform.elastic_energy(), mean, 2e-3 * mean);
  if (mean > 1) {
    EXPECT_LT(varied.critical_step(), uniform.critical_step());
  }
}

TEST(StiffnessField, WithoutDeviationNothingChanges) {
  const auto run = [](const PlantOptions& options) {
    HyperelasticPlant plant(options);
    Eigen::Matrix3Xd velocities = plant.rest_positions();
    velocities.row(0) *= 6;
    plant.set_state(plant.rest_positions(), velocities);
    for (int i = 0; i < 50; ++i) plant.step(1e-3);
    return plant.positions();
  };
  PlantOptions none = block(0);
  none.stiffness_field = {};
  EXPECT_TRUE((run(block(0)).array() == run(none).array()).all());
  EXPECT_FALSE((run(block(0.1)).array() == run(none).array()).all());
}

TEST(StiffnessField, RefusesNonsense) {
  EXPECT_THROW(StiffnessField({-0.1, 0.1, 1}), std::invalid_argument);
  EXPECT_THROW(StiffnessField({std::nan(""), 0.1, 1}), std::invalid_argument);
  EXPECT_THROW(StiffnessField({0.1, 0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::object
