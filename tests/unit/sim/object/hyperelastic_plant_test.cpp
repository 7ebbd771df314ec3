#include "sim/object/hyperelastic_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

constexpr double kGravity = 9.81;

PlantOptions bar() {
  PlantOptions options;
  options.clamp = face_x(0);
  return options;
}

math::Pose hand_at_end() {
  math::Pose X = math::Pose::Identity();
  X.translation() = Eigen::Vector3d(0.5, 0.03, 0.03);
  return X;
}

Eigen::Matrix3Xd random_field(int n, double size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Eigen::Matrix3Xd field(3, n);
  for (double& value : field.reshaped()) value = uniform(generator);
  return field;
}

TEST(HyperelasticPlant, StaysAtRestWithoutLoad) {
  HyperelasticPlant plant(small_free_block());
  for (int i = 0; i < 100; ++i) plant.step(1e-3, math::Pose::Identity(), {});
  EXPECT_LT((plant.positions() - plant.rest_positions()).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(HyperelasticPlant, FreeBodyKeepsMomentumAndEnergy) {
  HyperelasticPlant plant(small_free_block());
  const int n = static_cast<int>(plant.rest_positions().cols());
  const Eigen::Vector3d spin(3, -5, 8);
  Eigen::Matrix3Xd velocities(3, n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d p = plant.rest_positions().col(i);
    velocities.col(i) = Eigen::Vector3d(0.3, 0.1, -0.2) + spin.cross(p) +
                        Eigen::Vector3d(20 * p.x() * p.x(), 10 * p.x() * p.y(), -15 * p.z());
  }
  plant.set_state(plant.rest_positions(), velocities);
  const Eigen::Vector3d linear = linear_momentum(plant);
  const Eigen::Vector3d angular = angular_momentum(plant);
  const double energy = plant.kinetic_energy() + plant.elastic_energy();
  double most_elastic = 0;
  double early = 0;  // mean error of the energy over the first and the last quarter of a second
  double late = 0;
  for (int i = 0; i < 3000; ++i) {
    plant.step(1e-3, math::Pose::Identity(), {});
    most_elastic = std::max(most_elastic, plant.elastic_energy());
    const double error = plant.kinetic_energy() + plant.elastic_energy() - energy;
    if (i < 250) early += error / 250;
    if (i >= 2750) late += error / 250;
    EXPECT_LT(std::abs(error), 0.05 * energy);  // it oscillates with the square of the step
  }
  EXPECT_LT((linear_momentum(plant) - linear).norm(), 1e-11 * linear.norm());
  EXPECT_LT((angular_momentum(plant) - angular).norm(), 1e-11 * angular.norm());
  EXPECT_GT(most_elastic, 0.02 * energy);  // it does deform
  EXPECT_LT(std::abs(late - early), 0.005 * energy);
  std::printf("energy drift over 3 s: %.2g of the energy\n", (late - early) / energy);
}

TEST(HyperelasticPlant, EnergyErrorFallsWithTheSquareOfTheStep) {
  double drift[2] = {};
  for (const int refinement : {1, 2}) {
    PlantOptions options = small_free_block();
    options.substeps = 8 * refinement;
    HyperelasticPlant plant(options);
    Eigen::Matrix3Xd velocities = plant.rest_positions();
    velocities.row(0) *= 6;
    plant.set_state(plant.rest_positions(), velocities);
    const double energy = plant.kinetic_energy();
    for (int i = 0; i < 200; ++i) {
      plant.step(1e-3, math::Pose::Identity(), {});
      const double now = plant.kinetic_energy() + plant.elastic_energy();
      drift[refinement - 1] = std::max(drift[refinement - 1], std::abs(now - energy));
    }
  }
  EXPECT_NEAR(drift[0] / drift[1], 4, 1);
}

TEST(HyperelasticPlant, CriticalStepDividesStableFromUnstable) {
  for (const double viscosity : {0.0, 3.0}) {
    PlantOptions options = small_free_block();
    options.grasps = {hold(face_x(0.10))};
    options.grasps[0].stiffness = 3e3;
    options.grasps[0].damping = 0;
    options.viscosity = viscosity;
    options.substeps = 1;
    HyperelasticPlant plant(options);
    for (const double factor : {0.98, 1.1}) {
      const Eigen::Matrix3Xd noise = random_field(plant.rest_positions().cols(), 1e-9, 3);
      plant.set_state(plant.rest_positions() + noise, 0 * noise);
      for (int i = 0; i < 400; ++i)
        plant.step(factor * plant.critical_step(), math::Pose::Identity(), {});
      const double motion = (plant.positions() - plant.rest_positions()).cwiseAbs().maxCoeff();
      // The bound for lagged damping adds the worst of two modes: conservative, not sharp.
      if (factor < 1) {
        EXPECT_LT(motion, 1e-7);
      }
      if (factor > 1 && viscosity == 0) {
        EXPECT_FALSE(motion < 1e-6);  // large or NaN
      }
    }
  }
}

TEST(HyperelasticPlant, TipForceBendsAsTimoshenkoSays) {
  PlantOptions options = bar();
  options.poisson_ratio = 0;  // beam theory holds at the clamp too
  HyperelasticPlant plant(options);
  const double force = 1e-4;
  plant.add_force(plant.locate({0.5, 0.03, 0.03}), {0, 0, force});
  const auto settled = plant.settle(60, 1e-7);
  EXPECT_TRUE(settled.converged);
  const double area = 0.06 * 0.06;
  const double inertia = 0.06 * std::pow(0.06, 3) / 12;
  const double shear = 0.5 * 30e3;
  const double bending = force * std::pow(0.5, 3) / (3 * 30e3 * inertia);
  const double expected = bending + force * 0.5 / (5.0 / 6 * shear * area);
  // On the tip's axis the point force dents the section; its upper and lower edges are unaffected.
  const double deflection = plant.position_at({0.5, 0.0, 0.0}).z();
  EXPECT_NEAR(deflection, expected, 0.005 * expected);
  std::printf("tip deflection / Timoshenko: %.5f\n", deflection / expected);
}

TEST(HyperelasticPlant, SagsAsBeamTheorySaysAndTheClampBearsTheWeight) {
  PlantOptions options = bar();
  options.poisson_ratio = 0;
  options.gravity_O = {0, 0, -0.01 * kGravity};  // small deflection
  HyperelasticPlant plant(options);
  EXPECT_TRUE(plant.settle(60, 1e-7).converged);
  const double area = 0.06 * 0.06;
  const double inertia = 0.06 * std::pow(0.06, 3) / 12;
  const double load = 26 * area * 0.01 * kGravity;
  const double expected =
      load * std::pow(0.5, 4) / (8 * 30e3 * inertia) + load * 0.25 / (2 * 5.0 / 6 * 15e3 * area);
  const double sag = 0.03 - plant.position_at({0.5, 0.03, 0.03}).z();
  EXPECT_NEAR(sag, expected, 0.005 * expected);
  const double weight = load * 0.5;
  const math::Wrench clamp = plant.clamp_wrench();
  EXPECT_NEAR(clamp.force.z(), weight, 1e-5 * weight);
  EXPECT_NEAR(clamp.torque.y(), -weight * 0.25, 1e-2 * weight * 0.25);
}

TEST(HyperelasticPlant, HandAndClampBalanceTheWeight) {
  PlantOptions options = bar();
  options.grasps = {hold(face_x(0.5), hand_at_end())};
  options.gravity_O = {0, 0, -kGravity};
  HyperelasticPlant plant(options);
  EXPECT_TRUE(plant.settle(30, 1e-6).converged);
  plant.step(1e-3, hand_at_end(), {});

  const Eigen::VectorXd& masses = plant.nodal_masses();
  const Eigen::Vector3d weight = masses.sum() * options.gravity_O;
  Eigen::Vector3d weight_torque = Eigen::Vector3d::Zero();
  for (int n = 0; n < masses.size(); ++n) {
    weight_torque += plant.positions().col(n).cross(masses[n] * options.gravity_O);
  }
  const math::Wrench hand = plant.hand_wrench();
  const math::Wrench clamp = plant.clamp_wrench();
  EXPECT_GT(hand.force.z(), 0.3 * weight.norm());
  EXPECT_LT((hand.force + clamp.force + weight).norm(), 1e-4 * weight.norm());
  const Eigen::Vector3d torque =
      hand.torque + hand_at_end().translation().cross(hand.force) + clamp.torque;
  EXPECT_LT((torque + weight_torque).norm(), 1e-4 * weight_torque.norm());
}

TEST(HyperelasticPlant, HandWrenchIsTheImpulseThatMovesAFreeBody) {
  PlantOptions options = small_free_block();
  options.grasps = {hold(face_x(0.10))};
  HyperelasticPlant plant(options);
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  math::Pose X = math::Pose::Identity();
  const Eigen::Vector3d velocity(0.05, 0.1, -0.02);
  for (int i = 0; i < 300; ++i) {
    X.translation() += 1e-3 * velocity;
    plant.step(1e-3, X, {velocity, Eigen::Vector3d::Zero()});
    impulse += 1e-3 * plant.hand_wrench().force;
  }
  EXPECT_GT(impulse.norm(), 1e-4);
  EXPECT_LT((linear_momentum(plant) - impulse).norm(), 1e-9 * impulse.norm());
}

TEST(HyperelasticPlant, FollowsTheHandRigidlyWhenFree) {
  PlantOptions options = small_free_block();
  options.grasps = {hold(face_x(0.10))};
  options.mass_damping = 5;
  options.viscosity = 1;
  HyperelasticPlant plant(options);
  math::Pose X = math::Pose::Identity();
  for (int i = 1; i <= 1000; ++i) {
    X.linear() = Eigen::AngleAxisd(1e-3 * i, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    plant.step(1e-3, X, {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()});
  }
  EXPECT_TRUE(plant.settle(30, 1e-5).converged);
  EXPECT_LT((plant.positions() - X * plant.rest_positions()).colwise().norm().maxCoeff(), 1e-6);
}

TEST(HyperelasticPlant, RunsAreBitEqual) {
  PlantOptions options = bar();
  options.grasps = {hold(face_x(0.5), hand_at_end())};
  options.gravity_O = {0, 0, -kGravity};
  const auto run = [&options] {
    HyperelasticPlant plant(options);
    math::Pose X = hand_at_end();
    for (int i = 0; i < 200; ++i) {
      X.translation().x() -= 1e-4;
      plant.step(1e-3, X, {{-0.1, 0, 0}, Eigen::Vector3d::Zero()});
    }
    return plant.positions();
  };
  EXPECT_TRUE((run().array() == run().array()).all());
}

TEST(HyperelasticPlant, InvertedElementsStayFiniteAndRecover) {
  PlantOptions options = small_free_block();
  options.mass_damping = 20;
  options.viscosity = 0.5;
  HyperelasticPlant plant(options);
  const Eigen::Matrix3Xd scramble = random_field(plant.rest_positions().cols(), 0.03, 7);
  plant.set_state(plant.rest_positions() + scramble, 0 * scramble);
  const double energy = plant.elastic_energy();
  ASSERT_GT(energy, 0);
  for (int i = 0; i < 1000; ++i) plant.step(1e-3, math::Pose::Identity(), {});
  ASSERT_TRUE(plant.positions().allFinite());
  EXPECT_LT(plant.elastic_energy(), 0.1 * energy);
  std::printf("energy left after scrambling: %.2g\n", plant.elastic_energy() / energy);
}

TEST(HyperelasticPlant, RefusesNonsense) {
  const auto refuses = [](auto change) {
    PlantOptions options = bar();
    change(options);
    EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  };
  refuses([](PlantOptions& o) { o.size.y() = 0; });
  refuses([](PlantOptions& o) { o.elements[2] = 0; });
  refuses([](PlantOptions& o) { o.young_modulus = -1; });
  refuses([](PlantOptions& o) { o.poisson_ratio = 0.5; });
  refuses([](PlantOptions& o) { o.density = std::nan(""); });
  refuses([](PlantOptions& o) { o.clamp = face_x(0.011); });
  refuses([](PlantOptions& o) { o.grasps = {hold(face_x(9))}; });
  refuses([](PlantOptions& o) { o.substeps = -1; });
}

}  // namespace
}  // namespace palpate::object
