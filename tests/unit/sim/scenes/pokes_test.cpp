#include "sim/scenes/pokes.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

constexpr const char* kPoke =
    "pokes=[{at: 0.5, duration: 3, point: [0.25, 0.03, 0.06], force: [0, 0, -0.2]}]";

TEST(Poke, RisesStaysAndFallsWithoutAJump) {
  const Poke poke{1, 2, Vector3d::Zero(), Vector3d::UnitZ()};
  for (double time : {0.0, 1.0, 3.0, 4.0}) EXPECT_EQ(poke.share(time), 0) << time;
  for (double time : {1.1, 2.0, 2.9}) EXPECT_EQ(poke.share(time), 1) << time;
  EXPECT_NEAR(poke.share(1.05), 0.5, 1e-12);
  EXPECT_NEAR(poke.share(2.95), 0.5, 1e-12);
  for (double time = 0.9; time < 3.1; time += 1e-3)
    EXPECT_LT(std::abs(poke.share(time + 1e-3) - poke.share(time)), 0.016) << time;
  const Poke tap{1, 0.1, Vector3d::Zero(), Vector3d::UnitZ()};
  EXPECT_NEAR(tap.share(1.05), 1, 1e-12);  // the full force, at the middle
}

TEST(Poke, BendsTheBarAsABeamAndLetsItComeBack) {
  // Clamped at both ends, the middle deflects by F L^3 / 192 E I, and by F L / 4 k G A in shear.
  Stage stage(kControl, {kPoke, "object.damping=30", "object.pads.damping=0"});
  const object::HyperelasticPlant& plant = stage.simulation.plant();
  const Vector3d middle(0.225, 0.03, 0.03);
  const double before = plant.position_at(middle).z();
  const Vector3d rig = plant.clamp_wrench().force, hand = plant.hand_wrench().force;
  stage.run(3);
  const double L = 0.45, E = 30e3, I = 0.06 * 0.06 * 0.06 * 0.06 / 12, G = E / 2.6, A = 0.06 * 0.06;
  const double sag = 0.2 * (L * L * L / (192 * E * I) + L / (4 * 5.0 / 6 * G * A));
  EXPECT_NEAR(before - plant.position_at(middle).z(), sag, 0.1 * sag);
  // Hand and rig carry the additional load of the poke.
  const Vector3d added = plant.clamp_wrench().force - rig + plant.hand_wrench().force - hand;
  EXPECT_LT((added - Vector3d(0, 0, 0.2)).norm(), 0.01);
  stage.run(3);
  EXPECT_NEAR(plant.position_at(middle).z(), before, 0.02 * sag);
}

TEST(Poke, MassHangsInTheGravityOfTheSceneForAsLongAsWanted) {
  const Scene s = read_scene(config::Node::load_file(
      kControl, {"pokes=[{at: 1, duration: 1e5, point: [0.25, 0.03, 0.06], mass: 0.05}]",
                 "object.pose={position: [1.36, 0.03, 0.28], rpy_deg: [90, 0, 180]}"}));
  ASSERT_EQ(s.pokes.size(), 1u);
  EXPECT_NEAR(s.pokes[0].force.norm(), 0.05 * 9.81, 1e-12);
  EXPECT_LT((s.X_WO.linear() * s.pokes[0].force - Vector3d(0, 0, -0.05 * 9.81)).norm(), 1e-12);
  for (const double time : {1.2, 100.0, 9e4}) EXPECT_EQ(s.pokes[0].share(time), 1) << time;
  EXPECT_THROW(read_scene(config::Node::load_file(kControl, {kPoke, "pokes.0.mass=0.1"})),
               config::Error);
}

TEST(Poke, WrongOnesAreRefusedWithTheirKey) {
  for (const char* wrong : {"pokes.0.point=[0.6, 0, 0]", "pokes.0.point=[0, -0.01, 0]",
                            "pokes.0.duration=0", "pokes.0.at=-1", "pokes.0.forces=[0, 0, 0]"}) {
    const std::string key = std::string(wrong).substr(0, std::string(wrong).find('='));
    try {
      read_scene(config::Node::load_file(kControl, {kPoke, wrong}));
      FAIL() << wrong;
    } catch (const config::Error& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read_scene(config::Node::load_file(kControl, {kPoke})).pokes.size(), 1u);
  EXPECT_TRUE(read_scene(config::Node::load_file(kControl)).pokes.empty());
}

}  // namespace
}  // namespace palpate::scenes
