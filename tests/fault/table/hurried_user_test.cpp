#include <gtest/gtest.h>

#include "tools/lab/faults/replay.hpp"

namespace palpate::faults {
namespace {

constexpr int kTicks = 700, kMoves = 400;  // ms; the hand moves at that time

const Recording& recording() {
  static const Recording kRecording = record_loop(kTicks);
  return kRecording;
}

/// At kMoves a fault stops the loop; `pause` ms later, while the hand still brakes, the user
/// restarts it.
Trace hurried(const char* stops, const std::vector<const char*>& goes_on, int pause) {
  Replay replay(recording());
  return replay.run(recording().stream, kTicks, [&](int tick, daemon::Now&) {
    if (tick == kMoves && *stops != '\0') replay.user().send({stops}, 0);
    if (tick == kMoves && *stops == '\0') replay.daemon().pipeline().fault("test");
    if (tick == kMoves + pause)
      for (const char* event : goes_on) replay.user().send({event}, 0);
    return true;
  });
}

void expect_no_step(const Trace& trace) {
  ASSERT_GT(trace.cycles[kMoves - 2].speed, 0.01);
  EXPECT_TRUE(trace.sound()) << trace.complaint;
  EXPECT_EQ(trace.cycles.back().state, pipeline::LifeCycle::kActive);
}

TEST(HurriedUser, StartsWhileTheHandStillStops) {
  for (const int pause : {1, 5, 20, 60}) expect_no_step(hurried("stop", {"start"}, pause));
}

TEST(HurriedUser, ResetsWhileTheHandStillStops) {
  for (const int pause : {1, 5, 20, 60}) expect_no_step(hurried("", {"reset", "start"}, pause));
}

}  // namespace
}  // namespace palpate::faults
