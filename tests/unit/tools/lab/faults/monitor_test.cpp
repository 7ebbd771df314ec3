#include "tools/lab/faults/monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <palpate/contacts_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/twist_command_t.hpp>

namespace palpate::faults {
namespace {

class MonitorTest : public testing::Test {
 protected:
  template <class Message>
  void show(const char* channel, const Message& message) {
    bus::Published published{channel, std::vector<std::uint8_t>(message.getEncodedSize()), 0};
    message.encode(published.data.data(), 0, message.getEncodedSize());
    monitor_.look(published, p_W_E_, restrained_);
  }
  void command(double x, double turn = 0) {
    twist_command_t message{};
    message.valid = 1;
    message.twist[0] = x;
    message.twist[5] = turn;
    show("TWIST_COMMAND", message);
  }

  control::GateLimits limits_;  // 0.1 m/s, 0.5 m/s^2, 2 rad/s^2, workspace 1 m
  Monitor monitor_{limits_, 1e-3};
  std::optional<Eigen::Vector3d> p_W_E_ = Eigen::Vector3d(0.5, 0, 0.5);
  bool restrained_ = false;
};

TEST_F(MonitorTest, CommandsAtTheLimitsAreSound) {
  for (int i = 1; i <= 200; ++i) command(5e-4 * i), command(5e-4 * i);
  EXPECT_EQ(monitor_.beyond_limits(), 0) << monitor_.complaint();
  EXPECT_NEAR(monitor_.largest_step(), 1, 1e-9);
}

TEST_F(MonitorTest, TooFastTooSuddenOrOutwardsIsReported) {
  command(6e-4);
  EXPECT_EQ(monitor_.beyond_limits(), 1);
  command(6e-4, 2.1e-3);
  EXPECT_EQ(monitor_.beyond_limits(), 2) << "turns too suddenly";
  p_W_E_->x() = 1.0001;
  command(9e-4, 2.1e-3);
  EXPECT_EQ(monitor_.beyond_limits(), 3) << "out of the workspace";
  p_W_E_->x() = 0;
  for (int i = 0; i < 210; ++i) command(9e-4 + 5e-4 * i, 2.1e-3);
  EXPECT_GT(monitor_.beyond_limits(), 3) << "above 0.1 m/s";
}

TEST_F(MonitorTest, ABrakingGateMayOnlyBrake) {
  for (int i = 1; i <= 100; ++i) command(5e-4 * i);
  restrained_ = true;
  command(0.05 - 1e-3);  // 0.1 m/s in 0.1 s
  EXPECT_EQ(monitor_.beyond_limits(), 0);
  command(0.05);
  EXPECT_EQ(monitor_.beyond_limits(), 1);
  command(0);
  EXPECT_EQ(monitor_.beyond_limits(), 2) << "at once is too sudden";
}

TEST_F(MonitorTest, EveryNumberCounts) {
  contacts_t contacts{};
  contacts.deviation[7] = INFINITY;
  show("CONTACTS", contacts);
  EXPECT_EQ(monitor_.not_finite(), 1);
  shape_t shape{};
  shape.xyz_count = 3;
  shape.xyz = {0, NAN, 0};
  show("SHAPE", shape);
  EXPECT_EQ(monitor_.not_finite(), 2);
  command(NAN);
  EXPECT_EQ(monitor_.not_finite(), 3);
  EXPECT_NE(monitor_.complaint().find("CONTACTS"), std::string::npos);
}

TEST_F(MonitorTest, UnreadableOrUnknownMessagesAreReported) {
  monitor_.look({"FEATURE", std::vector<std::uint8_t>(20), 0}, {}, false);
  monitor_.look({"NO_SUCH", std::vector<std::uint8_t>(20), 0}, {}, false);
  EXPECT_EQ(monitor_.undecoded(), 2);
}

TEST_F(MonitorTest, TheHashIsOfWhatIsSaidNotOfWhen) {
  command(1e-4);
  const std::uint64_t first = monitor_.take_hash();
  twist_command_t message{};
  message.valid = 1;
  message.twist[0] = 1e-4;
  message.utime = 77, message.seq = 5;
  show("TWIST_COMMAND", message);
  EXPECT_EQ(monitor_.take_hash(), first);
  command(2e-4);
  EXPECT_NE(monitor_.take_hash(), first);
}

}  // namespace
}  // namespace palpate::faults
