// A log recorded in lock-step, with all messages of the daemon in it.

#include <gtest/gtest.h>

#include <cmath>
#include <palpate/feature_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/sim_tick_t.hpp>

#include "rt/bus/event_log_reader.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/bus/messages.hpp"
#include "tools/replay/replay.hpp"

namespace palpate::replay {
namespace {

constexpr std::int64_t kSim = 1'600'000'000'000'000;   // us: the simulator's clock
constexpr std::int64_t kWall = 1'700'000'000'000'000;  // us: the recorder's

class Stepped : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  static void write(lcm::LogFile& log, std::int64_t utime, const std::string& channel,
                    std::vector<std::uint8_t> data) {
    lcm::LogEvent event{};
    event.timestamp = utime;
    event.channel = channel;
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    log.writeEvent(&event);
  }
  /// The hand moves sideways for `ticks` ms of the simulator, recorded in half the time; every 50th
  /// tick is repeated. The daemon's messages `said` follow their tick.
  void record(const std::string& name, int ticks, const std::string& said = "") const {
    const pipeline::Pipeline pipeline(config::Node::load_file(kExample), 1e-3);
    const math::Pose X_WE = pipeline.frames().X_WO * pipeline.object().body.grasps[0].X_OG_rest *
                            pipeline.frames().X_EG.inverse();
    std::unique_ptr<bus::EventLogReader> daemon;
    if (!said.empty()) daemon = std::make_unique<bus::EventLogReader>(path(said));
    const bus::LoggedEvent* word = daemon ? daemon->next() : nullptr;
    lcm::LogFile log(path(name), "w");
    for (int i = 0; i < ticks; ++i) {
      const std::int64_t utime = kWall + 500 * i;
      robot_state_t state{};
      state.session = 5;
      state.seq = i;
      state.utime = kSim + 1000 * i;
      state.joint_count = 7;
      const Eigen::Vector3d p =
          X_WE.translation() + Eigen::Vector3d(0, 0.02 * std::sin(0.005 * i), 0);
      for (int axis = 0; axis < 3; ++axis) state.position[axis] = p[axis];
      math::wxyz_from_rotation(X_WE.linear(), state.quaternion);
      write(log, utime, "ROBOT_STATE", bus::wire::encoded(state));
      sim_tick_t tick{};
      tick.session = 6;
      tick.seq = i;
      tick.utime = kSim + 1000 * i;
      tick.tick = i;
      tick.period_us = 1000;
      for (int repeat = 0; repeat < (i % 50 == 0 ? 2 : 1); ++repeat)
        write(log, utime, "SIM_TICK", bus::wire::encoded(tick));
      // By order only: the log of the daemon has the times of the ticks' messages.
      for (; word != nullptr && word->utime <= utime; word = daemon->next())
        write(log, utime + 100, word->channel, {word->data, word->data + word->size});
    }
  }
  ReplayResult run(const std::string& log, const std::string& output = "") const {
    ReplayOptions options;
    options.log = path(log);
    options.output = output.empty() ? "" : path(output);
    options.start = true;
    options.stepped = true;
    options.compare = true;
    return replay(config::Node::load_file(kExample), options);
  }

  static inline const std::string kExample =
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";
  support::ScratchFolder folder_;
};

TEST_F(Stepped, EachTickIsACycleAndWhatTheDaemonSaidComesOutAgain) {
  constexpr int kTicks = 400;
  record("sensors.lcmlog", kTicks);
  const ReplayResult first = run("sensors.lcmlog", "said.lcmlog");
  EXPECT_EQ(first.cycles, kTicks) << "repeated ticks are no cycles";
  EXPECT_EQ(first.shapes, kTicks / 10);
  EXPECT_EQ(first.comparison.at("FEATURE").recorded, 0);

  record("all.lcmlog", kTicks, "said.lcmlog");
  const ReplayResult again = run("all.lcmlog");
  EXPECT_EQ(again.shape_hash, first.shape_hash) << "its own words change nothing";
  EXPECT_EQ(again.messages, first.messages);
  EXPECT_GT(again.left_out, 4 * kTicks);
  for (const char* channel : {"TWIST_COMMAND", "FEATURE", "ESTIMATE", "CONTACTS", "SHAPE"}) {
    ASSERT_EQ(again.comparison.count(channel), 1u) << channel;
    const ChannelComparison& one = again.comparison.at(channel);
    EXPECT_EQ(one.recorded, std::string(channel) == "SHAPE" ? kTicks / 10 : kTicks) << channel;
    EXPECT_EQ(one.common, one.recorded) << channel;
    EXPECT_EQ(one.equal, one.recorded) << channel;
    EXPECT_LT(one.first_difference, 0) << channel;
  }
}

TEST_F(Stepped, ALogWithoutTicksIsRefused) {
  {
    lcm::LogFile log(path("none.lcmlog"), "w");
    write(log, kWall, "ROBOT_STATE", bus::wire::encoded(robot_state_t{}));
  }
  try {
    run("none.lcmlog");
    FAIL() << "no cycle can be made of it";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("SIM_TICK"), std::string::npos) << error.what();
  }
}

std::vector<std::uint8_t> feature(std::int64_t utime, std::int32_t seq, double value) {
  feature_t message{};
  message.utime = utime;
  message.seq = seq;
  message.session = seq + 7;
  message.value[0] = value;
  return bus::wire::encoded(message);
}

TEST(Comparison, ReportsTheFirstDifferenceAndIgnoresSessions) {
  Comparison comparison;
  const auto put = [&](bool recorded, const std::vector<std::uint8_t>& data) {
    const int size = static_cast<int>(data.size());
    recorded ? comparison.take_recorded("FEATURE", data.data(), size)
             : comparison.take_replayed("FEATURE", data.data(), size);
  };
  for (int i = 0; i < 10; ++i) {
    put(true, feature(1000 * i, i, i));
    if (i < 8) put(false, feature(1000 * i, 100 + i, i == 5 ? 5.0000001 : i));
  }
  put(false, feature(99'000, 1, 1));
  const ChannelComparison one = comparison.result().at("FEATURE");
  EXPECT_EQ(one.recorded, 10);
  EXPECT_EQ(one.replayed, 9);
  EXPECT_EQ(one.common, 8);
  EXPECT_EQ(one.equal, 7);
  EXPECT_EQ(one.first_difference, 5000);
}

TEST(Comparison, ConcernsWhatFollowsFromInputsAlone) {
  for (const char* channel : {"TWIST_COMMAND", "TWIST_COMMAND_1", "SHAPE", "FEATURE_1"})
    EXPECT_TRUE(Comparison::concerns(channel)) << channel;
  for (const char* channel : {"HEALTH", "FT_WRENCH", "TRUTH_SHAPE", "SIM_TICK"})
    EXPECT_FALSE(Comparison::concerns(channel)) << channel;
  Comparison comparison;
  const std::uint8_t few[8] = {};
  comparison.take_recorded("FEATURE", few, 8);  // too short for any message
  EXPECT_EQ(comparison.result().at("FEATURE").recorded, 0);
}

}  // namespace
}  // namespace palpate::replay
