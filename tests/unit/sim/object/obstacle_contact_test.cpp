#include "sim/object/obstacle_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/object/neo_hookean.hpp"
#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

using Eigen::Vector3d;

constexpr double kEarth = 9.81;

ObstacleOptions plane(const Vector3d& point, const Vector3d& normal, double friction = 0.5) {
  ObstacleOptions options;
  options.shape = HalfSpace{point, normal};
  options.friction = friction;
  return options;
}

/// A free block of 0.10 x 0.06 x 0.05 m on the plane z = 0.
PlantOptions block_on_table(double friction = 0.5) {
  PlantOptions options = small_free_block();
  options.obstacles = {plane(Vector3d::Zero(), Vector3d::UnitZ(), friction)};
  return options;
}

double energy(const HyperelasticPlant& plant) {
  double sum = plant.kinetic_energy() + plant.elastic_energy();
  for (int i = 0; i < plant.obstacle_count(); ++i) sum += plant.obstacle(i).energy();
  return sum;
}

void throw_down(HyperelasticPlant& plant, const Vector3d& velocity, double height) {
  Eigen::Matrix3Xd positions = plant.rest_positions();
  positions.row(2).array() += height;
  plant.set_state(positions, velocity.replicate(1, positions.cols()));
}

Vector3d velocity_of_centre(const HyperelasticPlant& plant) {
  return linear_momentum(plant) / plant.nodal_masses().sum();
}

TEST(Obstacle, PlaneBearsTheWeightOfABlockThatLiesOnIt) {
  PlantOptions options = block_on_table();
  options.gravity_O = {0, 0, -kEarth};
  HyperelasticPlant plant(options);
  EXPECT_TRUE(plant.settle(20, 1e-5).converged);
  plant.step(1e-3);
  const double weight = kEarth * plant.nodal_masses().sum();
  const ObstacleTouch& touch = plant.obstacle(0).touch();
  EXPECT_TRUE(touch.touching);
  EXPECT_NEAR(touch.wrench.force.z(), weight, 1e-3 * weight);
  EXPECT_NEAR(plant.obstacle(0).mean_wrench().force.z(), weight, 1e-3 * weight);
  EXPECT_LT(touch.wrench.force.head<2>().norm(), 1e-3 * weight);
  EXPECT_NEAR(touch.wrench.torque.x(), 0.03 * weight, 1e-3 * 0.03 * weight);
  EXPECT_NEAR(touch.wrench.torque.y(), -0.05 * weight, 1e-3 * 0.05 * weight);
  EXPECT_NEAR(touch.area, 0.10 * 0.06, 1e-9);
  EXPECT_LT(touch.depth, 1e-4);
}

TEST(Obstacle, FrictionHoldsUpToItsLimitAndThenTheBlockSlides) {
  constexpr double kObstacleFriction = 0.5;
  for (const double slope : {0.4, 0.7}) {
    PlantOptions options = block_on_table(kObstacleFriction);
    const double angle = std::atan(slope);
    options.gravity_O = kEarth * Vector3d(std::sin(angle), 0, -std::cos(angle));
    options.mass_damping = slope < kObstacleFriction ? 5 : 0;
    HyperelasticPlant plant(options);
    if (slope < kObstacleFriction) {
      EXPECT_TRUE(plant.settle(20, 1e-5).converged);
    } else {  // begins pressed onto the plane: a block that bounces is dragged by less
      options.gravity_O.x() = 0;
      HyperelasticPlant level(options);
      EXPECT_TRUE(level.settle(20, 1e-5).converged);
      plant.set_state(level.positions(), Eigen::Matrix3Xd::Zero(3, level.positions().cols()));
    }
    const Eigen::Matrix3Xd start = plant.positions();
    for (int i = 0; i < 500; ++i) plant.step(1e-3);
    const double speed = velocity_of_centre(plant).x();
    const double normal = kEarth * std::cos(angle);
    if (slope < kObstacleFriction) {
      EXPECT_LT(std::abs(speed), 1e-4);
      EXPECT_LT((plant.positions() - start).cwiseAbs().maxCoeff(), 1e-5);
      const Vector3d force = plant.obstacle(0).mean_wrench().force;
      EXPECT_NEAR(-force.x() / force.z(), slope, 0.02);
    } else {
      EXPECT_NEAR(speed, 0.5 * (slope - kObstacleFriction) * normal, 0.01 * 0.5 * slope * normal);
      EXPECT_NEAR(plant.obstacle(0).touch().slipping, plant.obstacle(0).touch().area, 1e-9);
    }
  }
}

/// Nominal axial stress, Pa, of the plant's material under a uniaxial stretch.
double uniaxial_stress(const NeoHookean& material, double stretch) {
  const double mu = material.shear_modulus, lambda = material.lame;
  double squared = 1;  // of the lateral stretch: free of traction there
  for (int i = 0; i < 20; ++i) {
    squared -=
        (squared - 1 + lambda / mu * std::log(stretch * squared)) / (1 + lambda / mu / squared);
  }
  return mu * (stretch - squared / stretch);
}

TEST(Obstacle, TwoPlanesCompressABlockUniformly) {
  PlantOptions options = small_free_block();
  options.elements = {3, 2, 2};
  options.mass_damping = 20;
  options.obstacles = {plane(Vector3d::Zero(), Vector3d::UnitZ(), 0),
                       plane({0, 0, 0.048}, -3 * Vector3d::UnitZ(), 0)};
  HyperelasticPlant plant(options);
  EXPECT_TRUE(plant.settle(20, 1e-6).converged);
  const double depth = plant.obstacle(0).touch().depth;
  EXPECT_LT(depth, 1e-4);
  const double stretch = (0.048 + 2 * depth) / 0.05;
  const double force =
      -0.10 * 0.06 *
      uniaxial_stress(NeoHookean::from_young(options.young_modulus, options.poisson_ratio),
                      stretch);
  for (const int side : {0, 1}) {
    const double pressing = (side == 0 ? 1 : -1) * plant.obstacle(side).touch().wrench.force.z();
    EXPECT_NEAR(pressing, force, 2e-3 * force) << side;
  }
  // A patch test: every node lies where the uniform stretch puts it.
  const Eigen::RowVectorXd expected = (stretch * plant.rest_positions().row(2)).array() - depth;
  EXPECT_LT((plant.positions().row(2) - expected).cwiseAbs().maxCoeff(), 2e-6);
}

PlantOptions bar_under_gravity() {
  PlantOptions options;
  options.clamp = face_x(0);
  options.elements = {12, 2, 1};
  options.grasps = {
      hold(face_x(0.5), math::make_pose(Eigen::Matrix3d::Identity(), {0.5, 0.03, 0.03}))};
  options.gravity_O = {0, 0, -kEarth};
  options.mass_damping = 20;
  return options;
}

/// Force and torque about the origin of O.
math::Vector6d sum_of_holds(const HyperelasticPlant& plant, const math::Pose& X_OG) {
  const math::Wrench hand = plant.hand_wrench();
  math::Vector6d sum = plant.clamp_wrench().vector();
  sum.head<3>() += hand.force;
  sum.tail<3>() += hand.torque + X_OG.translation().cross(hand.force);
  return sum;
}

math::Vector6d weight(const HyperelasticPlant& plant, const Vector3d& gravity) {
  math::Vector6d sum = math::Vector6d::Zero();
  for (int n = 0; n < plant.nodal_masses().size(); ++n) {
    const Vector3d force = plant.nodal_masses()[n] * gravity;
    sum.head<3>() += force;
    sum.tail<3>() += plant.positions().col(n).cross(force);
  }
  return sum;
}

TEST(Obstacle, BarPressedOverACylinderIsInEquilibrium) {
  math::Vector6d contact = math::Vector6d::Zero(), holds[2], weights[2];
  for (const bool present : {false, true}) {
    PlantOptions options = bar_under_gravity();
    if (present) {
      ObstacleOptions cylinder;
      cylinder.shape = Cylinder{{0.22, 0.03, -0.04}, {0.2, 1, 0}, 0.03};
      options.obstacles = {cylinder};
    }
    HyperelasticPlant plant(options);
    math::Pose X = options.grasps[0].X_OG_rest;
    for (int i = 0; i < 1000; ++i) {
      X.translation().z() -= 5e-5;
      plant.step(1e-3, X, {{0, 0, -0.05}, Vector3d::Zero()});
    }
    EXPECT_TRUE(plant.settle(20, 1e-5).converged);
    plant.step(1e-3);
    holds[present] = sum_of_holds(plant, X);
    weights[present] = weight(plant, options.gravity_O);
    if (!present) continue;
    contact = plant.obstacle(0).mean_wrench().vector();
    EXPECT_GT(plant.obstacle(0).touch().area, 2e-4);
    EXPECT_LT(plant.obstacle(0).touch().depth, 1e-4);
  }
  EXPECT_GT(contact(2), 0.2);  // N
  const double force = contact.head<3>().norm(), torque = contact.tail<3>().norm();
  const math::Vector6d rest = holds[true] + weights[true] + contact;
  EXPECT_LT(rest.head<3>().norm(), 1e-3 * force);
  EXPECT_LT(rest.tail<3>().norm(), 1e-3 * torque);
  const math::Vector6d change = holds[true] - holds[false] + weights[true] - weights[false];
  EXPECT_LT((change + contact).head<3>().norm(), 1e-3 * force);
  EXPECT_LT((change + contact).tail<3>().norm(), 1e-3 * torque);
}

TEST(Obstacle, BounceNeitherGainsNorLosesEnergy) {
  struct Case {
    double damping;  // s/m
    int substeps;    // of 0.2 ms; 0: as the plant chooses
    double error;    // of the energy
  };
  // At the stability limit the energy of the fastest vibrations, which the blow excites, is not
  // exact.
  for (const Case& c : {Case{0, 20, 0.01}, Case{0, 0, 0.1}, Case{20, 20, 0.01}}) {
    PlantOptions options = block_on_table(0);
    options.obstacles[0].damping = c.damping;
    options.substeps = c.substeps;
    HyperelasticPlant plant(options);
    const Vector3d velocity(0.1, 0, -0.5);
    throw_down(plant, velocity, 2e-3);
    const double first = energy(plant);
    double most = 0, deepest = 0;
    for (int i = 0; i < 500; ++i) {
      plant.step(2e-4);
      most = std::max(most, energy(plant));
      deepest = std::max(deepest, plant.obstacle(0).touch().depth);
    }
    EXPECT_GT(deepest, 5e-6);
    EXPECT_FALSE(plant.obstacle(0).touch().touching);  // it has left
    EXPECT_GT(velocity_of_centre(plant).z(), 0.1);
    EXPECT_NEAR(velocity_of_centre(plant).x(), velocity.x(), 1e-9);  // without friction
    EXPECT_LT(most, (1 + c.error) * first);
    if (c.damping == 0) {
      EXPECT_NEAR(energy(plant), first, c.error * first);
    } else {
      EXPECT_LT(energy(plant), 0.99 * first);
    }
    std::printf("damping %.0f s/m: energy at most %.4f, in the end %.4f\n", c.damping, most / first,
                energy(plant) / first);
  }
}

TEST(Obstacle, FrictionOnlyTakesEnergy) {
  PlantOptions options = block_on_table(0.8);
  options.substeps = 20;
  HyperelasticPlant plant(options);
  throw_down(plant, {0.6, 0, -0.5}, 2e-3);
  const double first = energy(plant);
  double last = first;
  for (int i = 0; i < 500; ++i) {
    plant.step(2e-4);
    ASSERT_LT(energy(plant), last + 0.01 * first);
    last = std::min(last, energy(plant));
  }
  EXPECT_LT(last, 0.95 * first);
}

TEST(Obstacle, CylinderHasRoundSideAndFlatEnds) {
  const Cylinder cylinder{{0.1, 0, 0}, Vector3d::UnitY(), 0.03, 0.2};
  EXPECT_NEAR(cylinder.distance({0.1, 0.02, 0.04}), 0.01, 1e-15);
  EXPECT_NEAR(cylinder.distance({0.1, 0.13, 0.01}), 0.03, 1e-15);
  EXPECT_NEAR(cylinder.distance({0.1, -0.099, 0.01}), -0.001, 1e-15);
  EXPECT_EQ(cylinder.outward({0.1, 0.02, 0.029}), Vector3d(0, 0, 1));
  EXPECT_EQ(cylinder.outward({0.1, -0.099, 0.01}), Vector3d(0, -1, 0));
  for (const Vector3d& p : {Vector3d(0.11, 0.03, 0.02), Vector3d(0.09, 0.095, -0.02)}) {
    Vector3d slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d aside = 1e-7 * Vector3d::Unit(axis);
      slope[axis] = (cylinder.distance(p + aside) - cylinder.distance(p - aside)) / 2e-7;
    }
    EXPECT_LT((slope - cylinder.outward(p)).norm(), 1e-6);
  }
}

TEST(Obstacle, LeavesNoTraceBehindAndRunsAreBitEqual) {
  const auto run = [] {
    PlantOptions options = bar_under_gravity();
    options.gravity_O.setZero();
    options.obstacles = {plane({0, 0, -0.01}, Vector3d::UnitZ())};
    HyperelasticPlant plant(options);
    math::Pose X = options.grasps[0].X_OG_rest;
    bool touched = false;
    for (int i = 0; i < 800; ++i) {
      const double speed = i < 400 ? -0.05 : 0.05;
      X.translation().z() += 1e-3 * speed;
      plant.step(1e-3, X, {{0, 0, speed}, Vector3d::Zero()});
      touched = touched || plant.obstacle(0).touch().touching;
    }
    EXPECT_TRUE(touched);
    EXPECT_TRUE(plant.settle(20, 1e-5).converged);
    EXPECT_FALSE(plant.obstacle(0).touch().touching);
    EXPECT_EQ(plant.obstacle(0).mean_wrench().force.norm(), 0);
    EXPECT_LT((plant.positions() - plant.rest_positions()).cwiseAbs().maxCoeff(), 1e-5);
    return plant.positions();
  };
  EXPECT_TRUE((run().array() == run().array()).all());
}

TEST(Obstacle, OutOfReachItChangesNothing) {
  const auto run = [](bool present) {
    PlantOptions options = bar_under_gravity();
    if (present) options.obstacles = {plane({0, 0, -0.5}, Vector3d::UnitZ())};
    HyperelasticPlant plant(options);
    for (int i = 0; i < 100; ++i) plant.step(1e-3);
    return plant.positions();
  };
  EXPECT_TRUE((run(true).array() == run(false).array()).all());
}

TEST(Obstacle, RefusesNonsense) {
  const auto refuses = [](auto change) {
    PlantOptions options = block_on_table();
    change(options.obstacles[0]);
    EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  };
  refuses([](ObstacleOptions& o) { o.friction = -1; });
  refuses([](ObstacleOptions& o) { o.stiffness = -1; });
  refuses([](ObstacleOptions& o) { o.stiffness = 1e12; });  // no stable step
  refuses([](ObstacleOptions& o) { o.damping = std::nan(""); });
  refuses([](ObstacleOptions& o) { o.shape = HalfSpace{Vector3d::Zero(), Vector3d::Zero()}; });
  refuses([](ObstacleOptions& o) { o.shape = Cylinder{Vector3d::Zero(), Vector3d::UnitY(), 0}; });
  refuses([](ObstacleOptions& o) {
    o.shape = Cylinder{Vector3d::Zero(), Vector3d::UnitY(), 0.01, -1};
  });
}

}  // namespace
}  // namespace palpate::object
