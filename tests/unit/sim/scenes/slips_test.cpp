#include "sim/scenes/slips.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

constexpr const char* kSlip = "slips=[{at: 0.3, duration: 0.4, translation: [0.004, 0, 0]}]";

TEST(Slip, GrowsAlongHalfACosine) {
  const Slip slip{1, 0.5, 0, Vector3d::UnitX()};
  EXPECT_EQ(slip.share(0.9), 0);
  EXPECT_EQ(slip.share(1), 0);
  EXPECT_NEAR(slip.share(1.25), 0.5, 1e-12);
  EXPECT_EQ(slip.share(1.5), 1);
  EXPECT_EQ(slip.share(1e4), 1);
  for (const double time : {0.5, 1.1, 1.25, 1.4, 2.0})
    EXPECT_NEAR(slip.rate(time), (slip.share(time + 1e-6) - slip.share(time - 1e-6)) / 2e-6, 1e-6);
}

TEST(Slip, PushesTheBarTowardsTheClampAndNoSensorReportsIt) {
  Stage stage(kControl, coarse({kSlip, "object.damping=30", "object.gravity=false"}));
  stage.run(0.25);
  const object::HyperelasticPlant& plant = stage.simulation.plant();
  EXPECT_LT(plant.hand_wrench().force.norm(), 1e-3);
  stage.run(1.5);
  // The hand stands still; 4 mm of the bar are pushed into 0.428 m, along with the pads.
  const double bar = 0.428 / (30e3 * 0.06 * 0.06);
  const double force = 0.004 / (bar + 1e-4);
  EXPECT_NEAR(plant.hand_wrench().force.x(), -force, 0.1 * force);
  EXPECT_NEAR(plant.grasp().slip().distance, 0.004, 1e-9);
  for (const hand_state_t& state : stage.sent<hand_state_t>("HAND_STATE"))
    EXPECT_NE(state.grasp, hand_state_t::GRASP_SLIPPING);
}

TEST(Slip, WrongOnesAreRefusedWithTheirKey) {
  for (const char* wrong : {"slips.0.at=-1", "slips.0.duration=0", "slips.0.hand=1",
                            "slips.0.translation=[1, 0, 0]", "slips.0.force=1"}) {
    const std::string key = std::string(wrong).substr(0, std::string(wrong).find('='));
    try {
      read_scene(config::Node::load_file(kControl, {kSlip, wrong}));
      FAIL() << wrong;
    } catch (const config::Error& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read_scene(config::Node::load_file(kControl, {kSlip})).slips.size(), 1u);
}

}  // namespace
}  // namespace palpate::scenes
