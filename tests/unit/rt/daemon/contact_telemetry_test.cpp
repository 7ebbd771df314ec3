// Contacts that the model predicts, as published.
#include "rt/daemon/contact_telemetry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rt/bus/text.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::daemon {
namespace {

TEST(ContactTelemetry, HoldsEachPressingPointLargestFirst) {
  const config::Node root = config::Node::load_file(
      PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft_table.yaml",
      {"obstacles=[{name: shelf, shape: half_space, pose: {position: [0, 0, -1]}}, {name: table, "
       "shape: half_space, pose: {position: [0, 0, 0.255]}, friction: 0.5}]"});
  pipeline::Pipeline pipeline(root, 1e-3);
  sensing::Signals signals = support::at_rest(pipeline);
  pipeline.start();
  const math::Pose rest = signals.robot.latest.X_WE;
  for (int i = 0; i <= 300; ++i) {  // onto the table
    signals.robot.latest.X_WE.translation().z() = rest.translation().z() - 1e-4 * i;
    support::run(pipeline, signals, 1);
  }
  auto hub = bus::make_memory_hub();
  auto bus = bus::make_memory_bus(hub), user = bus::make_memory_bus(hub);
  bus::TypedSubscription<contacts_t> contacts(*user, "CONTACTS", 4);
  bus::TypedSubscription<obstacles_t> obstacles(*user, "OBSTACLES", 4);
  user->start();
  ContactTelemetry telemetry(*bus, 7);
  telemetry.publish(pipeline, 20123);
  contacts_t message;
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(contacts.take(message, arrival_ns));
  EXPECT_EQ(message.utime, 20123);
  EXPECT_EQ(message.obstacle_count, 2);
  EXPECT_STREQ(bus::get_text(message.obstacle_name[0]), "shelf");
  EXPECT_STREQ(bus::get_text(message.obstacle_name[1]), "table");
  EXPECT_EQ(message.obstacle_force[0], 0);

  double sum = 0;
  int pressing = 0;
  for (const elasticity::SurfaceContact& contact : pipeline.model().contacts()) {
    if (!contact.presses()) continue;
    ++pressing;
    sum += contact.normal_force();
  }
  ASSERT_GE(pressing, 2);
  EXPECT_EQ(message.predicted_count + message.predicted_omitted, pressing);
  EXPECT_EQ(message.predicted_count, std::min(pressing, 32));
  EXPECT_NEAR(message.obstacle_force[1], sum, 1e-5 * sum);
  double last = 1e9;
  for (int i = 0; i < message.predicted_count; ++i) {
    EXPECT_EQ(message.predicted_obstacle[i], 1);
    EXPECT_LE(message.predicted_force[i], last);
    last = message.predicted_force[i];
    EXPECT_GT(last, 0);
    EXPECT_NEAR(message.predicted_place[i][2], -0.025, 1e-4) << "25 mm below the bar, in O";
    EXPECT_NEAR(message.predicted_normal[i][2], 1, 1e-6);
    EXPECT_NEAR(message.predicted_friction[i][2], 0, 1e-6);
    const double friction =
        std::hypot(message.predicted_friction[i][0], message.predicted_friction[i][1]);
    if (message.predicted_slips[i] != 0) {
      EXPECT_NEAR(friction, 0.5 * last, 1e-4 * last);
    } else {
      EXPECT_LT(friction, 0.5 * last);
    }
  }

  obstacles_t poses;
  ASSERT_TRUE(obstacles.take(poses, arrival_ns));
  EXPECT_EQ(poses.count, 2);
  EXPECT_STREQ(bus::get_text(poses.name[1]), "table");
  EXPECT_EQ(poses.is_placed[1], 1);
  EXPECT_NEAR(poses.position[1][2], 0.255, 1e-12);
  EXPECT_NEAR(poses.quaternion[1][0], 1, 1e-12);
  EXPECT_EQ(poses.deviation[1][2], 0);
  telemetry.publish(pipeline, 21123);
  EXPECT_FALSE(obstacles.take(poses, arrival_ns)) << "every 10 ms";
}

}  // namespace
}  // namespace palpate::daemon
