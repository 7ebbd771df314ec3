#include "sim/object/fingertip_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// On the ground z = 0, top face at z = 0.024.
PlantOptions slab(const std::array<int, 3>& elements) {
  PlantOptions options;
  options.size = {0.048, 0.048, 0.024};
  options.elements = elements;
  options.clamp = Box{{-1, -1, 0}, {1, 1, 0}};
  options.mass_damping = 50;
  options.fingertips = {FingertipOptions()};
  options.fingertips[0].radius = 0.03;
  return options;
}

TEST(FingertipContact, SphereOnASlabFollowsHertz) {
  PlantOptions options = slab({12, 12, 6});
  options.fingertips[0].friction = 0;
  options.fingertips[0].stiffness = 1e8;  // stiff compared with the slab
  const double radius = 0.03, thickness = 0.024, nu = 0.3, modulus = 30e3 / (1 - nu * nu);
  for (const double indentation : {0.4e-3, 0.8e-3}) {
    HyperelasticPlant plant(options);
    plant.move_fingertip(0, {0.024, 0.024, thickness + radius - indentation}, {});
    EXPECT_TRUE(plant.settle(5, 1e-4).converged);
    const FingertipTouch& touch = plant.fingertip(0).touch();
    const double hertz = 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(indentation, 1.5);
    // A bonded layer of this thickness: Dimitriadis et al., Biophys. J. 82 (2002) 2798, eq. 13.
    const double a0 = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
    const double b0 = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
    const double x = std::sqrt(radius * indentation) / thickness;
    const double layer =
        1 - 2 * a0 / kPi * x + 4 * a0 * a0 / (kPi * kPi) * x * x -
        8 / std::pow(kPi, 3) * (std::pow(a0, 3) + 4 * kPi * kPi / 15 * b0) * std::pow(x, 3) +
        16 * a0 / std::pow(kPi, 4) * (std::pow(a0, 3) + 3 * kPi * kPi / 5 * b0) * std::pow(x, 4);
    EXPECT_NEAR(touch.force.z(), hertz * layer, 0.05 * hertz * layer);
    EXPECT_NEAR(touch.area, 1.1 * kPi * radius * indentation, 0.1 * kPi * radius * indentation);
    EXPECT_LT(touch.depth, 0.1 * indentation);
    EXPECT_NEAR(touch.normal.z(), 1, 1e-9);
    EXPECT_NEAR(touch.point.x(), 0.024, 1e-6);
    std::printf("force / (Hertz, layer): %.4f, layer %.3f, area / Hertz %.3f, depth %.2g\n",
                touch.force.z() / (hertz * layer), layer, touch.area / (kPi * radius * indentation),
                touch.depth / indentation);
  }
}

TEST(FingertipContact, ActionIsReaction) {
  // A free body whose momenta are changed by the tip alone.
  PlantOptions options = slab({4, 4, 2});
  options.clamp.reset();
  options.mass_damping = 0;
  HyperelasticPlant plant(options);
  Eigen::Vector3d centre(0.03, 0.02, 0.024 + 0.03 + 1e-3);
  const math::Twist V{{0.2, 0.05, -0.4}, {3, 0, 1}};
  plant.move_fingertip(0, centre, V);
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    centre += 1e-3 * V.linear;
    plant.move_fingertip(0, centre, V);
    plant.step(1e-3);
    impulse -= 1e-3 * plant.fingertip(0).mean_wrench().force;
    most = std::max(most, plant.fingertip(0).touch().friction.norm());
  }
  EXPECT_GT(most, 1e-3);
  EXPECT_LT((linear_momentum(plant) - impulse).norm(), 1e-11 * impulse.norm());
}

TEST(FingertipContact, TorqueIsReactionToo) {
  HyperelasticPlant plant(slab({4, 4, 2}));
  ContactSurface surface(even_grid({0, 0, 0}, {0.048, 0.048, 0.024}, {4, 4, 2}), 2e-3);
  FingertipOptions options;
  options.radius = 0.03;
  options.stiffness = 1e8;
  options.shear_stiffness = 1e4;
  FingertipContact tip(options, surface);
  const Eigen::Matrix3Xd& positions = plant.rest_positions();
  const Eigen::Matrix3Xd still = 0 * positions;
  const Eigen::Vector3d centre(0.03, 0.021, 0.024 + 0.029);
  tip.send(centre, {{0.1, -0.3, 0}, {2, 1, 3}});
  tip.begin();
  tip.advance(1);
  Eigen::Matrix3Xd forces = still;
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(positions.cols());
  tip.add_forces(surface, positions, still, 1e-4, forces, stiffness);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  for (int n = 0; n < positions.cols(); ++n) {
    const Eigen::Vector3d arm = positions.col(n) - centre, f = forces.col(n);
    force += f;
    torque += arm.cross(f);
  }
  const math::Wrench on_tip = tip.wrench();
  EXPECT_GT(on_tip.torque.norm(), 1e-6);
  EXPECT_LT((force + on_tip.force).norm(), 1e-12 * force.norm());
  EXPECT_LT((torque + on_tip.torque).norm(), 1e-12 * force.norm());
}

TEST(FingertipContact, SticksThenSlidesAtTheCone) {
  PlantOptions options = slab({4, 4, 2});
  options.fingertips[0].friction = 0.4;
  HyperelasticPlant plant(options);
  Eigen::Vector3d centre(0.018, 0.024, 0.024 + 0.03 - 1e-3);
  plant.move_fingertip(0, centre, {});
  for (int i = 0; i < 100; ++i) plant.step(1e-3);
  const FingertipTouch& touch = plant.fingertip(0).touch();
  EXPECT_TRUE(touch.sticking);
  const auto across = [&] { return touch.friction.norm() / touch.force.dot(touch.normal); };
  bool slid = false;
  for (int i = 0; i < 400; ++i) {
    centre.x() += 1e-5;
    plant.move_fingertip(0, centre, {{1e-2, 0, 0}, Eigen::Vector3d::Zero()});
    plant.step(1e-3);
    EXPECT_LE(across(), 0.4 * (1 + 1e-9));
    EXPECT_NEAR(touch.friction.dot(touch.normal), 0, 1e-12);
    slid = slid || !touch.sticking;
    if (i == 20) {
      EXPECT_FALSE(slid);  // so far the spring carries it
      EXPECT_GT(across(), 0.02);
    }
  }
  EXPECT_TRUE(slid);
  EXPECT_FALSE(touch.sticking);
  EXPECT_NEAR(across(), 0.4, 1e-9);
  EXPECT_LT(touch.friction.x(), 0);  // the object holds the tip back
  EXPECT_GT(touch.slipped, 1e-3);
  for (int i = 0; i < 100; ++i) plant.step(1e-3);
  EXPECT_TRUE(touch.sticking);
}

TEST(FingertipContact, LeavesNoTraceBehind) {
  HyperelasticPlant plant(slab({2, 2, 1}));
  plant.move_fingertip(0, {0.024, 0.024, 0.024 + 0.0285}, {});
  EXPECT_TRUE(plant.fingertip(0).touch().touching);
  plant.step(1e-3);
  plant.move_fingertip(0, {0.024, 0.024, 0.1}, {});
  plant.step(1e-3);
  plant.step(1e-3);
  EXPECT_TRUE(plant.settle(5, 1e-6).converged);
  EXPECT_LT((plant.positions() - plant.rest_positions()).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_EQ(plant.fingertip(0).mean_wrench().force.norm(), 0);
}

TEST(FingertipContact, HardBlowIsTakenWithoutGainOfEnergy) {
  PlantOptions options = slab({2, 2, 1});
  options.mass_damping = 0;
  options.fingertips[0].stiffness = 1e8;
  HyperelasticPlant plant(options);
  plant.move_fingertip(0, {0.024, 0.024, 0.024 + 0.0285}, {});  // there all at once
  const double first = plant.fingertip(0).energy();
  for (int i = 0; i < 300; ++i) {
    plant.step(1e-3);
    EXPECT_LT(plant.kinetic_energy() + plant.elastic_energy() + plant.fingertip(0).energy(),
              1.05 * first);
  }
}

TEST(FingertipContact, RunsAreBitEqual) {
  const auto run = [] {
    HyperelasticPlant plant(slab({4, 4, 2}));
    Eigen::Vector3d centre(0.02, 0.024, 0.024 + 0.0295);
    for (int i = 0; i < 100; ++i) {
      centre += Eigen::Vector3d(5e-5, 0, -5e-6);
      plant.move_fingertip(0, centre, {{0.05, 0, -0.005}, Eigen::Vector3d::Zero()});
      plant.step(1e-3);
    }
    return plant.positions();
  };
  EXPECT_TRUE((run().array() == run().array()).all());
}

TEST(FingertipContact, RefusesNonsense) {
  const auto refuses = [](auto change) {
    PlantOptions options = slab({2, 2, 1});
    change(options.fingertips[0]);
    EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  };
  refuses([](FingertipOptions& o) { o.radius = 0; });
  refuses([](FingertipOptions& o) { o.friction = -1; });
  refuses([](FingertipOptions& o) { o.stiffness = -1; });
  refuses([](FingertipOptions& o) { o.shear_stiffness = std::nan(""); });
}

}  // namespace
}  // namespace palpate::object
