// Requests for guarded motions and their answers, with an arm that obeys TWIST_COMMAND before a
// surface of known stiffness.

#include "rt/daemon/touching.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

constexpr const char* kTouchConfiguration =
    PALPATE_SOURCE_DIR "/rt/config/examples/touch_block.yaml";

class TouchingTest : public ::testing::Test {
 protected:
  TouchingTest() { make({}); }

  void make(const std::vector<std::string>& overrides) {
    std::vector<std::string> all = {"sensing=[{component: ft_tare_only, tare_at_start: true}]",
                                    "control.force_play=0"};  // an ideal sensor
    all.insert(all.end(), overrides.begin(), overrides.end());
    daemon_ = std::make_unique<Daemon>(config::Node::load_file(kTouchConfiguration, all), *inside_,
                                       *inside_, Mode::kDeterministic, 1);
  }

  /// Until `seconds` have passed, or the motion of the last TOUCH has ended.
  void run(double seconds, bool until_end = false) {
    for (int i = 0; i < static_cast<int>(1000 * seconds); ++i) {
      now_ns_ += 1'000'000;
      bus::set_time(*hub_, now_ns_);
      publish_sensors();
      daemon_->tick({now_ns_, now_ns_ / 1000, 0});
      std::int64_t arrival_ns = 0;
      for (twist_command_t twist; twists_.take(twist, arrival_ns);)
        if (twist.valid) x_ += 1e-3 * twist.twist[0];
      for (touch_t touch; touches_.take(touch, arrival_ns);) heard_.push_back(touch);
      if (until_end && !heard_.empty() && heard_.back().state >= touch_t::TOUCHED) return;
    }
  }

  void publish_sensors() {
    robot_state_t robot{};
    robot.session = 1;
    robot.seq = ++seq_;
    robot.utime = now_ns_ / 1000;
    robot.joint_count = 7;
    robot.position[0] = x_;
    robot.position[2] = 0.11;
    // E of the example's scene: z along x of W, x down.
    Eigen::Matrix3d R_WE;
    R_WE << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    math::wxyz_from_rotation(R_WE, robot.quaternion);
    bus::TypedPublisher<robot_state_t>(*outside_, "ROBOT_STATE").publish(robot);
    ft_wrench_t force{};
    force.session = 1;
    force.seq = seq_;
    force.utime = now_ns_ / 1000;
    const double depth = x_ - 0.658 - surface_;
    force.wrench[0] = 40 + 1e-4 * (seq_ % 2);  // a payload, and noise
    force.wrench[2] = depth > 0 ? 2780 * std::pow(depth, 1.5) : 0;
    if (!mute_) bus::TypedPublisher<ft_wrench_t>(*outside_, "FT_WRENCH").publish(force);
  }

  void event(const char* name) {
    component_command_t message{};
    message.session = 42;
    message.counter = ++counter_;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, name);
    bus::TypedPublisher<component_command_t>(*outside_, "COMPONENT_COMMAND").publish(message);
  }

  void start() {
    run(0.6);
    event("start");
    run(0.01);
  }

  void ask(std::int32_t number, std::int32_t action = touch_request_t::START,
           std::int64_t session = 42, double force = 0.2) {
    touch_request_t message{};
    message.session = session;
    message.action = action;
    message.request = number;
    message.direction[0] = 1;
    message.force = force;
    bus::TypedPublisher<touch_request_t>(*outside_, "TOUCH_REQUEST").publish(message);
  }

  std::string reason() const { return bus::get_text(heard_.back().reason); }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> inside_ = bus::make_memory_bus(hub_);
  bus::TypedSubscription<twist_command_t> twists_{*outside_, "TWIST_COMMAND", 16};
  bus::TypedSubscription<touch_t> touches_{*outside_, "TOUCH", 64};
  std::unique_ptr<Daemon> daemon_;
  std::vector<touch_t> heard_;
  std::int64_t now_ns_ = 1'000'000'000, counter_ = 0;
  std::int32_t seq_ = 0;
  double x_ = 0.658;       // m, of the flange in W
  double surface_ = 0.01;  // m, from the tip's front along x
  bool mute_ = false;
};

TEST_F(TouchingTest, ATouchIsCarriedOutOnceAndReported) {
  start();
  ask(5);
  ask(5);
  run(20, true);
  ASSERT_FALSE(heard_.empty());
  const touch_t touch = heard_.back();
  ASSERT_EQ(touch.state, touch_t::TOUCHED) << reason();
  EXPECT_EQ(touch.request, 5);
  // Centre: flange + 0.04 m to G + 0.272 m; the point is 10 mm ahead.
  EXPECT_NEAR(touch.centre[0], 0.658 + 0.312 + surface_, 3e-5);
  EXPECT_NEAR(touch.point[0], touch.centre[0] + 0.01, 1e-9);
  EXPECT_NEAR(touch.centre[1], 0.011, 1e-6);
  EXPECT_NEAR(touch.stiffness, 2780 * std::sqrt(touch.indentation), 5);
  EXPECT_GT(touch.point_deviation, 0);
  const std::size_t count = heard_.size();
  run(3);
  const double after = x_;
  EXPECT_NEAR(static_cast<double>(heard_.size() - count), 20, 2) << "repeated for one second";
  ask(5);  // late: everything of the end was lost
  run(0.5);
  EXPECT_EQ(heard_.back().state, touch_t::TOUCHED);
  EXPECT_EQ(x_, after) << "not carried out again";
}

TEST_F(TouchingTest, IsPublishedTwentyTimesASecond) {
  start();
  ask(1);
  run(0.01);
  ASSERT_EQ(heard_.size(), 1u) << "at once";
  EXPECT_EQ(heard_[0].state, touch_t::WAITING);
  run(1);
  EXPECT_NEAR(static_cast<double>(heard_.size()), 21, 1);
}

TEST_F(TouchingTest, RefusalsSayWhy) {
  run(0.6);
  ask(1);
  run(0.01);
  ASSERT_EQ(heard_.size(), 1u);
  EXPECT_EQ(heard_[0].state, touch_t::REFUSED);
  EXPECT_NE(reason().find("start"), std::string::npos) << reason();
  start();
  ask(1);
  run(0.01);
  EXPECT_EQ(heard_.back().state, touch_t::REFUSED) << "the same request";
  ask(2, touch_request_t::START, 42, 99);
  run(0.01);
  EXPECT_NE(reason().find("force_limit"), std::string::npos) << reason();
  ask(0);
  ask(3, 77);
  run(0.01);
  EXPECT_NE(reason().find("unknown action"), std::string::npos) << reason();
  ask(4);
  run(0.5);
  ask(4, touch_request_t::START, 43);  // another sender
  run(0.01);
  bool is_refused = false;
  for (const touch_t& touch : heard_)
    is_refused = is_refused || std::string(bus::get_text(touch.reason)).find("another") == 0;
  EXPECT_TRUE(is_refused);
  run(20, true);
  EXPECT_EQ(heard_.back().state, touch_t::TOUCHED) << reason();
}

TEST_F(TouchingTest, AnotherLawRefuses) {
  make({"control={provider: kinematic, law: proportional_twist}"});
  start();
  ask(1);
  run(0.01);
  ASSERT_EQ(heard_.size(), 1u);
  EXPECT_EQ(heard_[0].state, touch_t::REFUSED);
  EXPECT_NE(reason().find("guarded_motion"), std::string::npos) << reason();
}

TEST_F(TouchingTest, EndsAsItsSenderOrTheDaemonWants) {
  start();
  ask(1);
  run(1.5);
  ask(9, touch_request_t::CANCEL);  // not this one
  run(0.1);
  EXPECT_EQ(heard_.back().state, touch_t::APPROACHING);
  ask(1, touch_request_t::CANCEL);
  run(0.2);
  EXPECT_EQ(heard_.back().state, touch_t::STOPPED);
  EXPECT_EQ(reason(), "cancelled");
  const double there = x_;
  run(1);
  EXPECT_EQ(x_, there);

  ask(2);
  run(1.5);
  event("stop");
  run(0.1);
  EXPECT_EQ(heard_.back().request, 2);
  EXPECT_EQ(heard_.back().state, touch_t::STOPPED);
  EXPECT_EQ(reason(), "the daemon is not active");
}

TEST_F(TouchingTest, AStaleForceStopsIt) {
  start();
  ask(1);
  run(1.5);
  ASSERT_EQ(heard_.back().state, touch_t::APPROACHING);
  mute_ = true;
  run(0.3);
  EXPECT_EQ(heard_.back().state, touch_t::STOPPED);
  EXPECT_NE(reason().find("too old"), std::string::npos) << reason();
  const double there = x_;
  run(0.5);
  EXPECT_NEAR(x_, there, 1e-9);
}

TEST_F(TouchingTest, TheGatesForceLimitEndsIt) {
  make({"gate={force: 0.1}"});
  start();
  ask(1);
  run(20, true);
  EXPECT_EQ(heard_.back().state, touch_t::STOPPED);
  EXPECT_NE(reason().find("above its limit"), std::string::npos) << reason();
}

}  // namespace
}  // namespace palpate::daemon
