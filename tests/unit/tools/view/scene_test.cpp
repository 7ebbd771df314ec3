#include "tools/view/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rt/bus/text.hpp"
#include "tests/unit/tools/view/shapes.hpp"
#include "tools/view/live_source.hpp"

namespace palpate::view {
namespace {

template <class Message>
void give(Scene& scene, const char* channel, const Message& message, std::int64_t time_us = 1) {
  const auto data = encoded(message);
  scene.accept(channel, data.data(), static_cast<int>(data.size()), time_us);
}

TEST(Scene, KeepsTheLastOfAChannelAndEveryEvent) {
  Scene scene;
  health_t health{};
  for (int i = 0; i < 3; ++i) {
    health.cycles = i;
    give(scene, "HEALTH", health, 10 + i);
    component_event_t event{};
    bus::put_text(event.event, "zero");
    give(scene, "COMPONENT_EVENT", event, 20 + i);
  }
  EXPECT_EQ(scene.health.get(), nullptr) << "until refresh";
  scene.refresh();
  ASSERT_NE(scene.health.get(), nullptr);
  EXPECT_EQ(scene.health.get()->cycles, 2);
  EXPECT_EQ(scene.health.time_us, 12);
  ASSERT_EQ(scene.events().size(), 3U);
  EXPECT_EQ(scene.events()[2].number, 3);
  EXPECT_EQ(scene.events()[2].time_us, 22);
  scene.forget_messages();
  EXPECT_EQ(scene.health.get(), nullptr);
  EXPECT_TRUE(scene.events().empty());
}

TEST(Scene, RefusesMessagesThatSayImpossibleThings) {
  Scene scene;
  const auto mesh = box_mesh({1, 1, 1});
  shape_t shape = shape_of(*mesh, [](const Eigen::Vector3f& x) { return x; });
  shape.xyz[4] = std::nanf("");
  give(scene, "SHAPE", shape);
  feature_t feature{};
  feature.value_count = 33;
  give(scene, "FEATURE", feature);
  contacts_t contacts{};
  contacts.count = -1;
  give(scene, "CONTACTS", contacts);
  robot_state_t robot{};
  robot.joint_count = 17;
  give(scene, "ROBOT_STATE", robot);
  biotac_t fingertip{};
  fingertip.pac_count = 23;
  give(scene, "BIOTAC_0", fingertip);
  discrepancy_t discrepancy{};
  discrepancy.cause_count = 9;
  give(scene, "DISCREPANCY", discrepancy);
  scene.refresh();
  EXPECT_EQ(scene.rejected(), 6);
  EXPECT_EQ(scene.shape.get(), nullptr);
  EXPECT_EQ(scene.feature.get(), nullptr);
  EXPECT_EQ(scene.contacts.get(), nullptr);
  EXPECT_EQ(scene.robot[0].get(), nullptr);
  EXPECT_EQ(scene.fingertips[0].get(), nullptr);
  EXPECT_EQ(scene.discrepancy.get(), nullptr);
  contacts.count = 0;
  contacts.predicted_count = 1;
  contacts.predicted_obstacle[0] = 1;
  contacts.obstacle_count = 1;
  give(scene, "CONTACTS", contacts);
  contacts.predicted_count = 33;
  give(scene, "CONTACTS", contacts);
  contacts.obstacle_count = 9;
  give(scene, "CONTACTS", contacts);
  scene.refresh();
  EXPECT_EQ(scene.contacts.get(), nullptr);
}

TEST(Scene, JoinsTheChunksOfAShape) {
  Scene scene;
  shape_t chunk{};
  chunk.chunks = 2;
  chunk.node_count = 3;
  chunk.xyz = {1, 2, 3};
  chunk.xyz_count = 3;
  give(scene, "TRUTH_SHAPE", chunk, 10);
  EXPECT_EQ(scene.truth.get(), nullptr);
  chunk.chunk = 1;
  chunk.first_node = 1;
  chunk.xyz = {4, 5, 6, 7, 8, 9};
  chunk.xyz_count = 6;
  give(scene, "TRUTH_SHAPE", chunk, 11);
  ASSERT_NE(scene.truth.get(), nullptr);
  EXPECT_EQ(scene.truth.get()->xyz, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(scene.truth.time_us, 11);
  EXPECT_EQ(scene.truth.count, 1);
  EXPECT_EQ(scene.rejected(), 0);
}

TEST(Scene, JoinsTheDynamicPressureOfMessagesThatFollowEachOther) {
  Scene scene;
  const Fingertip& fingertip = scene.fingertips[7];
  biotac_t message{};
  message.session = 3;
  message.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC;
  message.pac_count = 22;
  const auto send = [&](int seq) {
    message.seq = seq;
    for (int i = 0; i < 22; ++i) message.pac[i] = static_cast<std::int16_t>(22 * seq + i);
    give(scene, "BIOTAC_2_1", message, 100 + seq);
  };
  EXPECT_EQ(fingertip.get(), nullptr);
  for (int seq = 1; seq <= 3; ++seq) send(seq);
  ASSERT_NE(fingertip.get(), nullptr);
  EXPECT_EQ(fingertip.get()->seq, 3);
  EXPECT_EQ(fingertip.time_us, 103);
  ASSERT_EQ(fingertip.pac.size(), 66U);
  for (int i = 0; i < 66; ++i) EXPECT_EQ(fingertip.pac[static_cast<std::size_t>(i)], 22 + i);
  for (int seq = 4; seq <= 30; ++seq) send(seq);
  ASSERT_EQ(fingertip.pac.size(), Fingertip::kMostPac);
  EXPECT_EQ(fingertip.pac.back(), 22 * 30 + 21) << "the newest remain";
  send(32);
  EXPECT_EQ(fingertip.pac.size(), 22U) << "message 31 was lost";
  message.session = 4;
  send(33);
  EXPECT_EQ(fingertip.pac.size(), 22U) << "another sender";
  message.valid = biotac_t::VALID_ELECTRODES;
  send(34);
  EXPECT_TRUE(fingertip.pac.empty()) << "not valid";
  scene.forget_messages();
  EXPECT_EQ(fingertip.get(), nullptr);
}

TEST(Scene, KeepsThePlaceOfEachObstacleThatMessagesMove) {
  Scene scene;
  world_state_t message{};
  message.quaternion[0] = 1;
  const auto send = [&](const std::string& name, double x, std::int64_t time_us) {
    bus::put_text(message.name, name);
    message.position[0] = x;
    give(scene, "WORLD_STATE", message, time_us);
  };
  send("plate", 1, 10);
  send("lid", 2, 10);
  send("plate", 3, 20);
  ASSERT_NE(scene.moved("plate"), nullptr);
  EXPECT_EQ(scene.moved("plate")->message.position[0], 3);
  EXPECT_EQ(scene.moved("plate")->time_us, 20);
  EXPECT_EQ(scene.moved("lid")->message.position[0], 2);
  EXPECT_EQ(scene.moved("tray"), nullptr);
  EXPECT_EQ(scene.rejected(), 0);
  send("", 0, 30);
  send("plate", std::nan(""), 30);
  message.quaternion[0] = 0.5;
  send("plate", 0, 30);
  EXPECT_EQ(scene.rejected(), 3);
  EXPECT_EQ(scene.moved("plate")->message.position[0], 3);
  message.quaternion[0] = 1;
  for (int i = 0; i < 7; ++i) send("name" + std::to_string(i), i, 30 + i);
  EXPECT_EQ(scene.moved("lid"), nullptr) << "of too many names the oldest is dropped";
  EXPECT_NE(scene.moved("plate"), nullptr);
  scene.forget_messages();
  EXPECT_EQ(scene.moved("plate"), nullptr);
}

TEST(Scene, ChannelsHaveOtherNamesOnTheBus) {
  Scene scene;
  LiveSource source({}, {{"FEATURE", "LEFT_FEATURE"}});
  const std::vector<std::uint8_t> payload = encoded(feature_t{});
  const auto send = [&](const std::string& channel) {
    std::string datagram("LC02\0\0\0\1", 8);
    datagram += channel + '\0';
    datagram.append(payload.begin(), payload.end());
    source.handle(scene, reinterpret_cast<const std::uint8_t*>(datagram.data()),
                  static_cast<int>(datagram.size()), 1);
    scene.refresh();
    return scene.feature.get() != nullptr;
  };
  EXPECT_FALSE(send("FEATURE"));
  EXPECT_TRUE(send("LEFT_FEATURE"));
}

/// For arbitrary bytes there is no crash and no implausible data are accepted.
TEST(Scene, BearsAnyBytes) {
  Scene scene;
  LiveSource source({});
  std::mt19937 random(7);
  const auto mesh = box_mesh({2, 2, 2});
  const std::vector<std::vector<std::uint8_t>> seeds = {
      encoded(shape_of(*mesh, [](const Eigen::Vector3f& x) { return x; })),
      encoded(*box_mesh({2, 2, 2})),
      encoded(health_t{}),
      encoded(component_event_t{}),
      encoded(feature_t{}),
      encoded(biotac_t{}),
      encoded(world_state_t{})};
  const char* const channels[] = {"SHAPE",   "SHAPE_MESH", "HEALTH",     "COMPONENT_EVENT",
                                  "FEATURE", "BIOTAC_0",   "WORLD_STATE"};
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t which = random() % seeds.size();
    std::vector<std::uint8_t> payload = seeds[which];
    for (unsigned flips = random() % 4; flips > 0; --flips)
      payload[random() % payload.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) payload.resize(random() % (payload.size() + 1));
    std::string datagram("LC02\0\0\0\1", 8);
    datagram += channels[which];
    if (random() % 16 != 0) datagram += '\0';
    datagram.append(payload.begin(), payload.end());
    if (random() % 16 == 0) datagram.resize(random() % 12);
    source.handle(scene, reinterpret_cast<const std::uint8_t*>(datagram.data()),
                  static_cast<int>(datagram.size()), i);
    scene.refresh();
    if (const shape_t* shape = scene.shape.get()) {
      ASSERT_EQ(shape->xyz.size(), static_cast<std::size_t>(3) * shape->node_count);
    }
  }
  EXPECT_GT(scene.rejected(), 1'000);
  EXPECT_GT(source.counters().malformed, 100);
  EXPECT_GT(scene.health.count, 100) << "what is sound came through";
}

}  // namespace
}  // namespace palpate::view
