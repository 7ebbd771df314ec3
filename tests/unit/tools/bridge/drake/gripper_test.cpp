#include "tools/bridge/drake/gripper.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

namespace palpate::drake_bridge {
namespace {

struct GripperStage {
  std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours = bus::make_memory_bus(hub);
  std::unique_ptr<bus::MessageBus> peer = bus::make_memory_bus(hub);
  Gripper gripper{*ours, *ours, {}, {}};
  bus::TypedPublisher<hand_command_t> commands{*peer, "HAND_COMMAND"};
  bus::TypedPublisher<::drake::lcmt_schunk_wsg_status> statuses{*peer, "SCHUNK_WSG_STATUS"};
  bus::TypedSubscription<::drake::lcmt_schunk_wsg_command> targets{*peer, "SCHUNK_WSG_COMMAND", 64};
  bus::TypedSubscription<hand_state_t> states{*peer, "HAND_STATE", 64};
  std::int64_t utime = 1'000'000;
  std::int32_t seq = 0;

  void send(std::int32_t action, double force = 0) {
    hand_command_t command{};
    command.session = 1;
    command.seq = ++seq;
    command.action = action;
    command.force = force;
    commands.publish(command);
  }
  void report(double mm, double force, double speed = 0) {
    ::drake::lcmt_schunk_wsg_status status{};
    status.actual_position_mm = mm;
    status.actual_force = force;
    status.actual_speed_mm_per_s = speed;
    statuses.publish(status);
  }
  /// Targets sent in `ms`, of which the last is returned.
  int run(int ms, ::drake::lcmt_schunk_wsg_command& last) {
    for (int i = 0; i < ms; ++i, utime += 1000) gripper.cycle(utime);
    int count = 0;
    std::int64_t arrival_ns = 0;
    while (targets.take(last, arrival_ns)) ++count;
    return count;
  }
  std::optional<hand_state_t> state() {
    gripper.cycle(utime += 10'000);
    hand_state_t last{};
    std::int64_t arrival_ns = 0;
    bool any = false;
    while (states.take(last, arrival_ns)) any = true;
    return any ? std::optional<hand_state_t>(last) : std::nullopt;
  }
};

TEST(Gripper, SendsNothingBeforeACommandAndThenRepeatsIt) {
  GripperStage stage;
  ::drake::lcmt_schunk_wsg_command target{};
  EXPECT_EQ(stage.run(500, target), 0);
  stage.send(hand_command_t::OPEN);
  EXPECT_EQ(stage.run(200, target), 4);
  EXPECT_DOUBLE_EQ(target.target_position_mm, 110);
  EXPECT_DOUBLE_EQ(target.force, 40);
  stage.send(hand_command_t::HOLD, 15);
  EXPECT_GE(stage.run(2, target), 1) << "at once";
  EXPECT_DOUBLE_EQ(target.target_position_mm, 0);
  EXPECT_DOUBLE_EQ(target.force, 15);
}

TEST(Gripper, RefusesWhatItCannotExecute) {
  GripperStage stage;
  ::drake::lcmt_schunk_wsg_command target{};
  for (const double force : {0.0, -1.0, 81.0, std::numeric_limits<double>::quiet_NaN()})
    stage.send(hand_command_t::HOLD, force);
  stage.send(7);
  EXPECT_EQ(stage.run(100, target), 0);
  EXPECT_EQ(stage.gripper.rejected(), 5);
}

TEST(Gripper, ReportsWhetherItHoldsSomething) {
  GripperStage stage;
  ::drake::lcmt_schunk_wsg_command target{};
  EXPECT_FALSE(stage.state()) << "no status";
  stage.report(60, 20);
  ASSERT_TRUE(stage.state());
  stage.send(hand_command_t::CLOSE);
  stage.run(1, target);
  const auto grasp = [&stage](double mm, double force, double speed) {
    stage.report(mm, force, speed);
    const auto state = stage.state();
    EXPECT_TRUE(state);
    EXPECT_EQ(state->joint_count, 1);
    EXPECT_DOUBLE_EQ(state->q[0], 1e-3 * mm);
    return state->grasp;
  };
  EXPECT_EQ(grasp(60, -20, 0), hand_state_t::GRASP_HOLDING) << "the force's sign has no meaning";
  EXPECT_EQ(grasp(60, 20, 50), hand_state_t::GRASP_NONE) << "it still closes";
  EXPECT_EQ(grasp(60, 0, 0), hand_state_t::GRASP_NONE);
  EXPECT_EQ(grasp(0.2, 20, 0), hand_state_t::GRASP_NONE) << "the fingers press each other";
  stage.report(std::numeric_limits<double>::quiet_NaN(), 20);
  EXPECT_FALSE(stage.state());
  stage.send(hand_command_t::OPEN);
  stage.run(1, target);
  EXPECT_EQ(grasp(60, 20, 0), hand_state_t::GRASP_NONE);
}

}  // namespace
}  // namespace palpate::drake_bridge
