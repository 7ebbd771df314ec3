
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "tests/support/scratch_folder.hpp"
#include "tools/replay/play_command.hpp"

namespace palpate::replay {
namespace {

constexpr std::int64_t kMs = 1'000'000;                 // ns
constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // us

class PlayerTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// A log of messages at these ms after kBegin.
  std::string log(const std::string& name, const std::vector<int>& times) const {
    lcm::LogFile file(path(name), "w");
    for (const int time : times) {
      std::uint8_t byte = 1;
      lcm::LogEvent event{};
      event.timestamp = kBegin + std::int64_t{1000} * time;
      event.channel = name;
      event.datalen = 1;
      event.data = &byte;
      file.writeEvent(&event);
    }
    return path(name);
  }
  Sink sink() {
    return [this](int log, const bus::LoggedEvent& event) {
      played_.emplace_back(log, static_cast<int>((event.utime - kBegin) / 1000));
    };
  }
  /// Times of the messages played since the last call.
  std::vector<int> times() {
    std::vector<int> times;
    for (const auto& [number, time] : played_) times.push_back(time);
    played_.clear();
    return times;
  }

  support::ScratchFolder folder_;
  std::vector<std::pair<int, int>> played_;
};

using Times = std::vector<int>;

TEST_F(PlayerTest, PlaysEachMessageWhenItIsDue) {
  Player player({log("A", {0, 10, 20, 50})}, {});
  EXPECT_DOUBLE_EQ(player.duration(), 0.05);
  constexpr std::int64_t kNow = 777 * kMs;
  EXPECT_EQ(player.advance(kNow, sink()), 10 * kMs);
  EXPECT_EQ(times(), Times{0});
  EXPECT_EQ(player.advance(kNow + 9 * kMs, sink()), 1 * kMs);
  EXPECT_EQ(times(), Times{});
  EXPECT_EQ(player.advance(kNow + 25 * kMs, sink()), 25 * kMs);
  EXPECT_EQ(times(), (Times{10, 20}));
  EXPECT_NEAR(player.position(kNow + 25 * kMs), 0.025, 1e-9);
  EXPECT_LT(player.advance(kNow + 50 * kMs, sink()), 0) << "the end";
  EXPECT_EQ(times(), Times{50});
  EXPECT_EQ(player.played(), 4);
}

TEST_F(PlayerTest, LogsAreMergedByTime) {
  Player player({log("A", {0, 20, 40}), log("B", {10, 20, 30})}, {});
  EXPECT_LT(player.advance(0, sink()), kMs * 10 + 1);
  EXPECT_LT(player.advance(100 * kMs, sink()), 0);
  EXPECT_EQ(played_, (std::vector<std::pair<int, int>>{
                         {0, 0}, {1, 10}, {0, 20}, {1, 20}, {1, 30}, {0, 40}}));
}

TEST_F(PlayerTest, RatePauseAndStep) {
  PlayerOptions fast;
  fast.rate = 10;
  Player player({log("A", {0, 100, 200, 300, 1000})}, fast);
  player.advance(0, sink());
  player.advance(10 * kMs, sink());
  EXPECT_EQ(times(), (Times{0, 100}));
  player.pause(true, 15 * kMs);
  EXPECT_GT(player.advance(500 * kMs, sink()), 0);
  EXPECT_EQ(times(), Times{});
  EXPECT_NEAR(player.position(500 * kMs), 0.15, 1e-9);
  player.step(500 * kMs, sink());
  EXPECT_EQ(times(), Times{200});
  EXPECT_NEAR(player.position(500 * kMs), 0.2, 1e-9);
  player.pause(false, 1000 * kMs);
  player.set_rate(1, 1000 * kMs);
  player.advance(1099 * kMs, sink());
  EXPECT_EQ(times(), Times{});
  player.advance(1100 * kMs, sink());
  EXPECT_EQ(times(), Times{300});
}

TEST_F(PlayerTest, SeeksBothWaysWithoutPlayingWhatLiesBetween) {
  Player player({log("A", {0, 100, 200, 300, 400})}, {});
  player.advance(0, sink());
  player.seek(0.25, 0);
  player.advance(0, sink());
  EXPECT_EQ(times(), Times{0});
  player.advance(50 * kMs, sink());
  EXPECT_EQ(times(), Times{300});
  player.seek(0.1, 50 * kMs);
  player.advance(50 * kMs, sink());
  EXPECT_EQ(times(), Times{100});
  player.seek(-7, 50 * kMs);
  EXPECT_DOUBLE_EQ(player.position(50 * kMs), 0);
  player.seek(99, 50 * kMs);
  player.advance(50 * kMs, sink());
  EXPECT_EQ(times(), Times{400});
}

TEST_F(PlayerTest, APartIsPlayedAndRepeated) {
  PlayerOptions part;
  part.start = 0.1;
  part.end = 0.25;
  part.loop = true;
  Player player({log("A", {0, 100, 200, 300})}, part);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 40; ++i) now_ns += std::max<std::int64_t>(0, player.advance(now_ns, sink()));
  const Times all = times();
  ASSERT_GE(all.size(), 6u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], i % 2 == 0 ? 100 : 200);
}

TEST_F(PlayerTest, LongSilencesAreNotWaitedForAtOnce) {
  Player player({log("A", {0, 3'600'000})}, {});
  EXPECT_EQ(player.advance(0, sink()), 1'000'000'000);
}

TEST_F(PlayerTest, WrongPartsAndLogsAreRefused) {
  const std::string file = log("A", {0, 100});
  PlayerOptions late;
  late.start = 5;
  EXPECT_THROW(Player({file}, late), std::invalid_argument);
  PlayerOptions reversed;
  reversed.start = 0.05;
  reversed.end = 0.01;
  EXPECT_THROW(Player({file}, reversed), std::invalid_argument);
  EXPECT_THROW(Player({path("nowhere")}, {}), std::runtime_error);
  EXPECT_THROW(Player({log("EMPTY", {})}, {}), std::runtime_error);
}

TEST(PlayCommand, KnowsLabelsAndWhatMovesARobot) {
  std::string file;
  EXPECT_EQ(label_of("/a/run.housekeeping.lcmlog", file), "housekeeping");
  EXPECT_EQ(label_of("run.control.lcmlog.0", file), "control");
  EXPECT_EQ(label_of("any.log", file), "control");
  EXPECT_EQ(label_of("pictures=/a/any.log", file), "pictures");
  EXPECT_EQ(file, "/a/any.log");
  EXPECT_EQ(label_of("/a=b/any.log", file), "control");
  EXPECT_EQ(file, "/a=b/any.log");
  for (const char* channel :
       {"TWIST_COMMAND", "TWIST_COMMAND_1", "JOINT_VELOCITY_COMMAND", "HAND_COMMAND_1"}) {
    EXPECT_TRUE(is_command(channel)) << channel;
    EXPECT_FALSE(is_input(channel)) << channel;
  }
  for (const char* channel : {"FT_WRENCH", "ROBOT_STATE_1", "BIOTAC_4"}) {
    EXPECT_FALSE(is_command(channel)) << channel;
    EXPECT_TRUE(is_input(channel)) << channel;
  }
  for (const char* channel :
       {"SHAPE_TARGET", "COMPONENT_COMMAND", "MANUAL_FORCE", "TOUCH_REQUEST"}) {
    EXPECT_TRUE(is_command(channel)) << channel << " makes a daemon move the robot";
    EXPECT_TRUE(is_input(channel)) << channel;
  }
  EXPECT_FALSE(is_input("SHAPE"));
  EXPECT_FALSE(is_command("SHAPE"));
}

}  // namespace
}  // namespace palpate::replay
