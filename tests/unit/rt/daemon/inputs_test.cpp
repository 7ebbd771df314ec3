#include "rt/daemon/inputs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <palpate/biotac_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <set>

namespace palpate::daemon {
namespace {

class InputsTest : public ::testing::Test {
 protected:
  template <class Message>
  void send(const std::string& channel, Message message, int seq) {
    message.session = 3;
    message.seq = seq;
    bus::TypedPublisher<Message>(*sender_, channel).publish(message);
  }

  static InputReport report(const Inputs& inputs, const std::string& name) {
    for (int i = 0; i < inputs.channel_count(); ++i)
      if (inputs.report(i).name == name) return inputs.report(i);
    ADD_FAILURE() << "no input " << name;
    return {};
  }

  static robot_state_t robot_at(double x) {
    robot_state_t state{};
    state.joint_count = 7;
    state.quaternion[0] = 1;
    state.position[0] = x;
    return state;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> sender_ = bus::make_memory_bus(hub_);
};

TEST_F(InputsTest, ASecondArmAddsItsChannels) {
  const Inputs one(*bus_), two(*bus_, 2);
  EXPECT_EQ(one.channel_count(), 12);
  ASSERT_EQ(two.channel_count(), 16);
  std::set<std::string> names;
  for (int i = 0; i < two.channel_count(); ++i) names.insert(two.report(i).name);
  EXPECT_EQ(names.size(), 16u) << "each once";
  for (const char* name : {"FT_WRENCH_1", "IMU_1", "ROBOT_STATE_1", "HAND_STATE_1"})
    EXPECT_EQ(names.count(name), 1u) << name;
}

TEST_F(InputsTest, ArmsAreKeptApart) {
  Inputs inputs(*bus_, 2);
  bus::set_time(*hub_, 1'000'000);
  send("ROBOT_STATE", robot_at(0.1), 1);
  send("ROBOT_STATE_1", robot_at(0.2), 1);
  ft_wrench_t wrench{};
  wrench.wrench[2] = 5;
  send("FT_WRENCH_1", wrench, 1);
  inputs.read(3'000'000, 1e-3);
  EXPECT_EQ(inputs.signals(0).robot.latest.X_WE.translation().x(), 0.1);
  EXPECT_EQ(inputs.signals(1).robot.latest.X_WE.translation().x(), 0.2);
  EXPECT_EQ(inputs.signals(0).force_torque.freshness, Freshness::kNoData);
  EXPECT_EQ(inputs.signals(1).force_torque.latest.F_S.force.z(), 5);
  EXPECT_NEAR(report(inputs, "ROBOT_STATE_1").age, 2e-3, 1e-9);
  EXPECT_LT(report(inputs, "FT_WRENCH").age, 0) << "nothing was ever received";
}

TEST_F(InputsTest, WhatIsBadOrMissingOfTheSecondArmIsCountedAndNeverUsed) {
  Inputs inputs(*bus_, 2);
  send("ROBOT_STATE_1", robot_at(0.2), 1);
  inputs.read(0, 1e-3);
  send("ROBOT_STATE_1", robot_at(std::nan("")), 2);
  send("ROBOT_STATE_1", robot_at(0.3), 3);
  send("ROBOT_STATE_1", robot_at(9), 3);  // repeated
  const char wrong_size[16] = {};
  sender_->publish("ROBOT_STATE_1", wrong_size, sizeof wrong_size);
  send("ROBOT_STATE_1", robot_at(0.4), 7);  // three were lost
  inputs.read(1'000'000, 1e-3);
  const InputReport second = report(inputs, "ROBOT_STATE_1");
  EXPECT_EQ(inputs.signals(1).robot.latest.X_WE.translation().x(), 0.4);
  EXPECT_EQ(second.rejected, 3);
  EXPECT_EQ(second.lost, 3);
  EXPECT_EQ(report(inputs, "ROBOT_STATE").rejected, 0);
}

TEST_F(InputsTest, ASensorThatRepeatsItselfGrowsOldUntilItMoves) {
  Inputs inputs(*bus_);
  ft_wrench_t wrench{};
  int seq = 0;
  const auto second = [&](auto&& force) {
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t now_ns = std::int64_t{++seq} * 1'000'000;
      bus::set_time(*hub_, now_ns);
      wrench.wrench[0] = force(i);
      send("FT_WRENCH", wrench, seq);
      inputs.read(now_ns, 1e-3);
    }
  };
  second([](int i) { return i % 2; });
  EXPECT_EQ(report(inputs, "FT_WRENCH").frozen, 0);
  EXPECT_LT(inputs.signals().force_torque.age, 2e-3);
  second([](int) { return 7.0; });
  EXPECT_NEAR(static_cast<double>(report(inputs, "FT_WRENCH").frozen), 500, 3);
  EXPECT_NEAR(inputs.signals().force_torque.age, 0.5, 3e-3) << "since it last counted";
  EXPECT_EQ(inputs.signals().force_torque.freshness, Freshness::kOld);
  second([](int i) { return 7.5 + i % 2; });
  EXPECT_LT(inputs.signals().force_torque.age, 2e-3);
}

TEST_F(InputsTest, ContactsOfFingertipsAreCheckedAndReportedInPlaceOfTheirBiotac) {
  Inputs inputs(*bus_);
  int seq = 0;
  const auto is_accepted = [&](auto change) {
    fingertip_t tip{};
    tip.contact = 1;
    tip.place[0] = 0.01 * (seq + 1);
    tip.normal[2] = -1;
    tip.force[2] = -2;
    tip.place_deviation = tip.force_deviation = tip.area = -1;
    change(tip);
    send("FINGERTIP_3", tip, ++seq);
    inputs.read(seq * std::int64_t{1'000'000}, 1e-3);
    return inputs.signals().fingertip[3].fresh_count == 1;
  };
  const double nan = std::nan("");
  EXPECT_TRUE(is_accepted([](fingertip_t&) {}));
  const sensing::FingertipContact& contact = inputs.signals().fingertip[3].latest;
  EXPECT_TRUE(contact.touches);
  EXPECT_EQ(contact.place_T.x(), 0.01);
  EXPECT_EQ(contact.force_T.z(), -2);
  EXPECT_FALSE(is_accepted([](fingertip_t& tip) { tip.contact = 2; }));
  EXPECT_FALSE(is_accepted([](fingertip_t& tip) { tip.normal[2] = -1.1; }));
  EXPECT_FALSE(is_accepted([](fingertip_t& tip) { tip.place[1] = 0.6; })) << "not on a fingertip";
  for (double fingertip_t::*number :
       {&fingertip_t::place_deviation, &fingertip_t::force_deviation, &fingertip_t::area})
    EXPECT_FALSE(is_accepted([&](fingertip_t& tip) { tip.*number = nan; }));
  EXPECT_FALSE(is_accepted([&](fingertip_t& tip) { tip.force[0] = nan; }));
  EXPECT_FALSE(is_accepted([&](fingertip_t& tip) { tip.place[0] = nan; }));
  EXPECT_TRUE(is_accepted([&](fingertip_t& tip) {
    tip.contact = 0;
    tip.normal[2] = tip.place[0] = nan;  // not valid without a contact
  }));
  EXPECT_FALSE(inputs.signals().fingertip[3].latest.touches);
  EXPECT_EQ(inputs.signals().fingertip[3].latest.place_T.norm(), 0);
  EXPECT_EQ(report(inputs, "FINGERTIP_3").rejected, 8);
  EXPECT_EQ(inputs.channel_count(), 12);
  EXPECT_EQ(report(inputs, "BIOTAC_2").received, 0);
}

TEST_F(InputsTest, ARobotAtRestAndAGapAreNotFrozen) {
  Inputs inputs(*bus_);
  for (int seq = 1; seq <= 1000; ++seq) {
    const std::int64_t now_ns = std::int64_t{seq} * 2'000'000;
    bus::set_time(*hub_, now_ns);
    send("ROBOT_STATE", robot_at(0.1), seq);
    if (seq % 300 == 1) send("FT_WRENCH", ft_wrench_t{}, seq);
    inputs.read(now_ns, 1e-3);
  }
  EXPECT_EQ(report(inputs, "ROBOT_STATE").frozen, 0);
  EXPECT_EQ(report(inputs, "FT_WRENCH").frozen, 0);
}

TEST_F(InputsTest, NumbersBeyondWhatCanBeAreRejectedThoughFinite) {
  Inputs inputs(*bus_);
  ft_wrench_t wrench{};
  wrench.wrench[1] = 2;
  send("FT_WRENCH", wrench, 1);
  inputs.read(0, 1e-3);
  int seq = 1;
  for (const double number : {1e308, -1e308, 1e7, HUGE_VAL, std::nan("")}) {
    wrench.wrench[1] = number;
    send("FT_WRENCH", wrench, ++seq);
    send("ROBOT_STATE", robot_at(number), seq);
    inputs.read(1'000'000, 1e-3);
    EXPECT_EQ(inputs.signals().force_torque.latest.F_S.force.y(), 2) << number;
    EXPECT_EQ(inputs.signals().robot.freshness, Freshness::kNoData) << number;
  }
  EXPECT_EQ(report(inputs, "FT_WRENCH").rejected, 5);
  wrench.wrench[1] = 5e-324;  // tiny values are as valid
  send("FT_WRENCH", wrench, ++seq);
  inputs.read(2'000'000, 1e-3);
  EXPECT_EQ(inputs.signals().force_torque.latest.F_S.force.y(), 5e-324);
}

TEST_F(InputsTest, ASenderThatRestartsIsReportedOnce) {
  Inputs inputs(*bus_, 2);
  const auto read = [&](std::int64_t session, int seq, std::int64_t now_ns) {
    imu_t message{};
    message.session = session;
    message.seq = seq;
    bus::set_time(*hub_, now_ns);
    bus::TypedPublisher<imu_t>(*sender_, "IMU_1").publish(message);
    inputs.read(now_ns, 1e-3);
    return inputs.any_session_restarted();
  };
  EXPECT_FALSE(read(5, 70, 1'000'000)) << "the first is no restart";
  EXPECT_FALSE(read(5, 71, 2'000'000));
  EXPECT_FALSE(read(6, 0, 3'000'000)) << "while the other sender still publishes";
  EXPECT_TRUE(read(6, 1, 210'000'000));
  EXPECT_FALSE(read(6, 2, 211'000'000));
  EXPECT_FALSE(read(5, 72, 420'000'000)) << "what is left of the old one";
  EXPECT_EQ(report(inputs, "IMU_1").rejected, 2);
}

TEST_F(InputsTest, AnObservationComesWholeOrNotAtAll) {
  Inputs inputs(*bus_);
  const auto& stream = inputs.signals().observation;
  shape_observation_t good{};
  good.utime = 2'500'000;
  good.count = 2;
  good.deviation = 1e-3;
  good.points[1][2] = 0.25F;
  good.points[2][0] = std::nanf("");  // beyond the count, values are ignored
  send("SHAPE_OBSERVATION", good, 1);
  inputs.read(1'000'000, 1e-3);
  ASSERT_EQ(stream.freshness, Freshness::kNew);
  EXPECT_EQ(stream.latest.count, 2);
  EXPECT_EQ(stream.latest.points_W(2, 1), 0.25F);
  EXPECT_EQ(stream.latest.deviation, 1e-3);
  EXPECT_EQ(stream.latest.time, 2.5);

  int seq = 1;
  const auto expect_refused = [&](auto&& spoil) {
    shape_observation_t bad = good;
    bad.points[1][2] = 0.5F;
    spoil(bad);
    send("SHAPE_OBSERVATION", bad, ++seq);
    inputs.read(std::int64_t{seq} * 1'000'000, 1e-3);
    EXPECT_EQ(stream.freshness, Freshness::kOld);
    EXPECT_EQ(stream.latest.points_W(2, 1), 0.25F);
    EXPECT_EQ(report(inputs, "SHAPE_OBSERVATION").rejected, seq - 1);
  };
  for (const float number : {std::nanf(""), HUGE_VALF, 1e7F})
    expect_refused([&](auto& m) { m.points[0][1] = number; });
  for (const double number : {0.0, -1e-3, 2.0, std::nan(""), HUGE_VAL})
    expect_refused([&](auto& m) { m.deviation = number; });
  for (const int number : {-1, 257, 1 << 30}) expect_refused([&](auto& m) { m.count = number; });
  EXPECT_NEAR(stream.age, 1e-3 * (seq - 1), 1e-2) << "what is refused does not keep it young";

  shape_observation_t nothing{};
  send("SHAPE_OBSERVATION", nothing, ++seq);
  inputs.read(std::int64_t{seq} * 1'000'000, 1e-3);
  EXPECT_EQ(stream.latest.count, 0) << "a camera that sees nothing";
  EXPECT_EQ(stream.freshness, Freshness::kNew);
}

}  // namespace
}  // namespace palpate::daemon
