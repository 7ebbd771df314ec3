// Messages about a moving obstacle that are invalid, foreign, forged, replayed or missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <palpate/component_event_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/world_state_t.hpp>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"
#include "rt/loop/allocation_counter.hpp"

namespace palpate::daemon {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr int kActive = 2, kDegraded = 3;  // of health_t.state

/// A running daemon with a key and an obstacle that messages move, with sensors at rest.
class WorldState : public ::testing::Test {
 protected:
  WorldState() {
    bus_->start();
    component_command_t start{};
    start.session = 1;
    bus::put_text(start.slot, "all");
    bus::put_text(start.event, "start");
    bus::MessageSigner("COMPONENT_COMMAND", access_).put(start, 0);
    bus::TypedPublisher<component_command_t>(*users_, "COMPONENT_COMMAND").publish(start);
    tick(200, [this] { send(signed_state(0.2)); });
  }
  ~WorldState() override { std::filesystem::remove(key_file_); }

  static std::filesystem::path new_key_file(const char* name) {
    const auto path = std::filesystem::temp_directory_path() / (name + std::to_string(getpid()));
    std::filesystem::remove(path);
    bus::make_key_file(path);
    return path;
  }

  /// The plate at a height, unsigned.
  world_state_t state(double height, const char* name = "plate") {
    world_state_t message{};
    message.session = 5;
    message.seq = ++seq_;
    message.utime = now_ns_ / 1000;
    bus::put_text(message.name, name);
    message.position[0] = 1.11;
    message.position[2] = height;
    message.quaternion[0] = 1;
    return message;
  }
  world_state_t signed_state(double height) {
    world_state_t message = state(height);
    signer_.put(message, 0);
    return message;
  }
  void send(const world_state_t& message) {
    bus::TypedPublisher<world_state_t>(*users_, "WORLD_STATE").publish(message);
  }

  template <class Message>
  void sense(const char* channel, Message message) {
    message.session = 3;
    message.seq = sensor_seq_;
    message.utime = now_ns_ / 1000;
    bus::TypedPublisher<Message>(*users_, channel).publish(message);
  }
  void sense_all() {
    ++sensor_seq_;
    const double noise = 1e-3 * std::sin(1.7 * sensor_seq_);
    const pipeline::Pipeline& pipeline = daemon_->pipeline();
    const math::Pose X_WE = pipeline.frames().X_WO * pipeline.object().body.grasps[0].X_OG_rest *
                            pipeline.frames().X_EG.inverse();
    robot_state_t robot{};
    std::copy_n(X_WE.translation().data(), 3, robot.position);
    math::wxyz_from_rotation(X_WE.linear(), robot.quaternion);
    sense("ROBOT_STATE", robot);
    ft_wrench_t force{};
    force.wrench[2] = noise;
    sense("FT_WRENCH", force);
    imu_t imu{};
    imu.acceleration[2] = 9.81 + noise;
    sense("IMU", imu);
    hand_state_t hand{};
    hand.grasp = hand_state_t::GRASP_HOLDING;
    sense("HAND_STATE", hand);
  }

  void tick(
      int count, const std::function<void()>& before = [] {}) {
    for (int i = 0; i < count; ++i) {
      bus::set_time(*hub_, now_ns_);
      sense_all();
      before();
      bus::record(*hub_, &published_);
      daemon_->tick({now_ns_, now_ns_ / 1000, 0});
      bus::record(*hub_, nullptr);
      for (const bus::Published& message : published_) {
        const int size = static_cast<int>(message.data.size());
        if (message.channel == "HEALTH") health_.decode(message.data.data(), 0, size);
        component_event_t event{};
        if (message.channel != "COMPONENT_EVENT" || event.decode(message.data.data(), 0, size) < 0)
          continue;
        if (std::string(bus::get_text(event.event)) == "no_access")
          refusals_ += bus::get_text(event.reason);
      }
      published_.clear();
      now_ns_ += 1'000'000;
    }
  }

  std::int64_t rejected() const {
    for (int i = 0; i < health_.input_count; ++i)
      if (std::string(bus::get_text(health_.input_name[i])) == "WORLD_STATE")
        return health_.rejected[i];
    ADD_FAILURE() << "no input WORLD_STATE";
    return -1;
  }
  /// Height of the plate as the daemon has it, m in W.
  double height() const {
    const collision::Placement& plate = daemon_->pipeline().obstacles().placements()[0];
    return (daemon_->pipeline().frames().X_WO * plate.X_OB).translation().z();
  }

  std::filesystem::path key_file_ = new_key_file("palpate_world_state_");
  bus::Access access_{bus::read_key_file(key_file_), 0};
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> users_ = bus::make_memory_bus(hub_);
  bus::MessageSigner signer_{"WORLD_STATE", access_};
  std::unique_ptr<Daemon> daemon_ = std::make_unique<Daemon>(
      config::Node::load_file(PALPATE_SOURCE_DIR
                              "/rt/config/examples/bar_long_soft_lift_table.yaml",
                              {"access.key_file=" + key_file_.string()}),
      *bus_, *bus_, Mode::kDeterministic, 1);
  std::vector<bus::Published> published_;
  health_t health_{};
  std::string refusals_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::int32_t seq_ = 0, sensor_seq_ = 0;
};

TEST_F(WorldState, AValidMessageMovesTheObstacle) {
  EXPECT_EQ(health_.state, kActive) << bus::get_text(health_.reason);
  EXPECT_NEAR(height(), 0.2, 1e-12);
  tick(20, [this] { send(signed_state(0.23)); });
  EXPECT_NEAR(height(), 0.23, 1e-12);
  world_state_t rising = state(0.23);
  rising.twist[2] = 0.1;
  signer_.put(rising, 0);
  send(rising);
  tick(51);
  EXPECT_NEAR(height(), 0.235, 1e-9) << "50 ms at 0.1 m/s";
  EXPECT_EQ(rejected(), 0);
}

TEST_F(WorldState, EachInvalidMessageIsCountedAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(world_state_t&)>> faults = {
      [&](world_state_t& m) { m.position[1] = nan; },
      [&](world_state_t& m) { m.position[2] = 1e7; },
      [&](world_state_t& m) { m.quaternion[0] = 2; },
      [&](world_state_t& m) { m.quaternion[3] = nan; },
      [&](world_state_t& m) { m.twist[4] = nan; },
      [&](world_state_t& m) { m.twist[0] = 11; },
      [&](world_state_t& m) { m.twist[5] = 51; },
      [&](world_state_t& m) { bus::put_text(m.name, "plates"); },
      [&](world_state_t& m) { bus::put_text(m.name, ""); },
      [&](world_state_t& m) { std::fill_n(m.name, 24, 'p'); },
  };
  std::int64_t expected = 0;
  for (const auto& fault : faults) {
    tick(1, [&] {
      world_state_t message = state(0.5);
      fault(message);
      signer_.put(message, 0);
      send(message);
      send(signed_state(0.2));
    });
    tick(110, [this] { send(signed_state(0.2)); });
    EXPECT_EQ(rejected(), ++expected);
    EXPECT_NEAR(height(), 0.2, 1e-12);
  }
  EXPECT_EQ(health_.state, kActive) << bus::get_text(health_.reason);
  EXPECT_EQ(refusals_, "") << "all were signed";
}

TEST_F(WorldState, ForgedAndReplayedMessagesAreCountedReportedAndChangeNothing) {
  const auto other_file = new_key_file("palpate_world_state_other_");
  bus::MessageSigner foreign{"WORLD_STATE", {bus::read_key_file(other_file), 0}};
  std::filesystem::remove(other_file);
  const world_state_t recorded = signed_state(0.5);
  tick(1, [&] { send(recorded); });
  EXPECT_NEAR(height(), 0.5, 1e-12);
  tick(1, [&] { send(signed_state(0.2)); });
  tick(1, [&] { send(state(0.6)); });  // not signed
  tick(1, [&] {
    world_state_t message = state(0.6);
    foreign.put(message, 0);
    send(message);
  });
  tick(1, [&] {
    world_state_t message = signed_state(0.2);
    message.position[2] = 0.6;  // after signing
    send(message);
  });
  tick(1, [&] { send(recorded); });
  EXPECT_NEAR(height(), 0.2, 1e-12);
  tick(200, [this] { send(signed_state(0.2)); });
  EXPECT_EQ(rejected(), 4);
  EXPECT_EQ(health_.commands_rejected, 4);
  EXPECT_THAT(refusals_, HasSubstr("WORLD_STATE"));
  EXPECT_EQ(health_.state, kActive) << bus::get_text(health_.reason);
}

TEST_F(WorldState, SilenceDegradesUntilMessagesComeAgain) {
  tick(1, [this] {
    world_state_t rising = state(0.2);
    rising.twist[2] = 0.1;
    signer_.put(rising, 0);
    send(rising);
  });
  tick(90);
  EXPECT_EQ(health_.state, kActive) << bus::get_text(health_.reason);
  tick(20);
  EXPECT_EQ(health_.state, kDegraded);
  EXPECT_STREQ(bus::get_text(health_.reason), "plate: no message moves this obstacle any more");
  const double last = height();
  EXPECT_NEAR(last, 0.21, 2e-4) << "it moved on for the time-out";
  tick(300, [this] { send(state(0.5)); });  // not signed: as good as silence
  EXPECT_EQ(health_.state, kDegraded);
  EXPECT_EQ(height(), last);
  tick(200, [this] { send(signed_state(0.2)); });
  EXPECT_EQ(health_.state, kActive) << bus::get_text(health_.reason);
}

TEST_F(WorldState, AFloodOfInvalidMessagesCostsNoAllocation) {
  for (int i = 0; i < 300; ++i) {
    bus::set_time(*hub_, now_ns_);
    sense_all();
    for (int k = 0; k < 10; ++k) send(k % 2 == 0 ? state(0.5) : state(0.5, "nothing"));
    send(signed_state(0.2));
    const loop::NoAllocationScope scope;
    daemon_->tick({now_ns_, now_ns_ / 1000, 0});
    EXPECT_EQ(scope.count(), 0) << i;
    now_ns_ += 1'000'000;
  }
  tick(100, [this] { send(signed_state(0.2)); });
  EXPECT_EQ(rejected(), 3000);
  EXPECT_NEAR(height(), 0.2, 1e-12);
}

}  // namespace
}  // namespace palpate::daemon
