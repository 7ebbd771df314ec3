#include <cmath>
#include <cstdio>

#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

const char* const kTactileLoopScene = "sim/scenes/bar_soft_tactile.yaml";

struct TactileSensors {
  const char* configuration;
  double force, place;  // N, m: largest errors
};

class TactileLoop : public testing::TestWithParam<TactileSensors> {};

// Fingertips of robot and plant, BioTac messages and the linear force map or messages of other
// fingertips, fingertip poses of HAND_STATE: the daemon's estimate of the fingers' contacts agrees
// with the truth.
TEST_P(TactileLoop, ContactsAreThoseOfTheFingers) {
  ClosedLoop loop(kTactileLoopScene, GetParam().configuration);
  loop.run(0.9);
  loop.send_event("start");
  loop.run(3.0);
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  EXPECT_TRUE(pipeline.is_running()) << pipeline.condition().reason;
  const object::HyperelasticPlant& plant = loop.simulation().plant();
  int seen = 0;
  const sensing::ContactSet& contacts = pipeline.contacts();
  for (int i = 0; i < contacts.count; ++i) {
    const sensing::Contact& contact = contacts.contacts[i];
    const int finger =
        static_cast<int>(contact.source) - static_cast<int>(sensing::Source::kFinger0);
    const object::FingertipTouch& touch = plant.fingertip(finger).touch();
    ASSERT_TRUE(touch.touching) << finger;
    ++seen;
    const Eigen::Vector3d force = -touch.force;  // on the object
    std::printf("finger %d: force error %.3f N of %.3f N, place error %.2f mm\n", finger,
                (contact.wrench.force - force).norm(), force.norm(),
                1e3 * (contact.location - touch.point).norm());
    EXPECT_LT((contact.wrench.force - force).norm(), GetParam().force) << finger;
    EXPECT_LT((contact.location - touch.point).norm(), GetParam().place) << finger;
  }
  EXPECT_EQ(seen, 3);  // middle and ring finger, thumb
  // The bar of 200 mm sags between fingertips and clamp, which the fingertips do not show: 17
  // and 42.
  const Eigen::VectorXd error = loop.shape_error();
  std::printf("shape: mean %.2f mm, max %.2f mm\n", 1e3 * error.mean(), 1e3 * error.maxCoeff());
  EXPECT_LT(error.mean(), 20e-3);
  EXPECT_LT(error.maxCoeff(), 50e-3);
}

// Of the map: two and a half times its RMS error on random presses all over the skin. Of a reported
// place: the contact of the plant's sphere lies inside the skin.
INSTANTIATE_TEST_SUITE_P(
    Sensors, TactileLoop,
    testing::Values(TactileSensors{"rt/config/examples/bar_soft_tactile.yaml", 0.21, 2e-3},
                    TactileSensors{"rt/config/examples/bar_soft_fingertip.yaml", 0.11, 1.5e-3}),
    [](const auto& tested) { return std::string(tested.index == 0 ? "biotac" : "of_any_kind"); });

}  // namespace
}  // namespace palpate
