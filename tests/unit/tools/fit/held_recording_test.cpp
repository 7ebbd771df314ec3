#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>

#include "core/math/random.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/fit/held/held_log.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector3d;

/// A hand that rests 2 s, moves 0.1 m in 1 s, and so on: `rests` rests. The wrench is (start time
/// of the rest, 0, ...) at rest and far off while it moves.
class Recorded : public ::testing::Test {
 protected:
  void write(int rests, bool wrenches = true) {
    log::EventLog log(file_);
    math::Random random(1);
    for (int ms = 0; ms < 3000 * rests; ms += 2) {
      const double time = 1e-3 * ms, phase = std::fmod(time, 3);
      const double moving = std::max(0.0, phase - 2);
      robot_state_t state{};
      state.utime = 1000 * ms;
      state.position[0] = 0.1 * (std::floor(time / 3) + moving) + 1e-6 * random.normal();
      state.quaternion[0] = 1;
      log.write("ROBOT_STATE", state.utime, state);
      ft_wrench_t wrench{};
      wrench.utime = 1000 * ms;
      wrench.wrench[0] = (moving > 0 ? 99 : time - phase) + 0.1 * random.normal();
      if (wrenches) log.write("FT_WRENCH", wrench.utime, wrench);
      if (ms % 100 == 50) {
        shape_observation_t seen{};
        seen.utime = 1000 * ms;
        seen.count = 1;
        seen.deviation = 0.001;
        seen.points[0][2] = static_cast<float>(ms % 200 == 50 ? 0.4 : 0.6);
        log.write("SHAPE_OBSERVATION", seen.utime, seen);
      }
    }
  }

  support::ScratchFolder folder_;
  std::string file_ = (folder_.path() / "hand.log").string();
};

TEST_F(Recorded, ASampleForEachRest) {
  write(4);
  CalmRule rule;
  rule.every = 2;
  const HeldRecording recording = read_held_recording(file_, rule, "sent", true);
  ASSERT_EQ(recording.samples.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    const HeldSample& sample = recording.samples[i];
    EXPECT_NEAR(sample.F_S.force.x(), 3 * i, 0.03);
    EXPECT_NEAR(sample.X_WE.translation().x(), 0.1 * i, 1e-6);
    EXPECT_GT(sample.time, 3 * i + rule.settle);
    EXPECT_LT(sample.time, 3 * i + 2);
    EXPECT_NEAR(sample.points_W(2, 0), 0.5, 0.03);  // the mean of the observed marker positions
  }
  EXPECT_GE(recording.samples[1].way.size(), 5u);  // 0.1 m in blocks of 0.01 m
}

// 0.1 N per message, at 500 Hz: 0.1 / sqrt(250) N in the mean over half a second.
TEST_F(Recorded, DeviationIsThatOfTheMean) {
  write(6);
  const HeldRecording recording = read_held_recording(file_, {}, "received", true);
  EXPECT_NEAR(recording.deviation[0], 0.1 / std::sqrt(250.0), 0.3 * 0.1 / std::sqrt(250.0));
  EXPECT_EQ(recording.deviation[1], 0);
  EXPECT_NEAR(recording.point_deviation, 0.001 / std::sqrt(5), 1e-4);
}

TEST_F(Recorded, SlowMotionCountsWhereTheRuleSaysSo) {
  write(3);
  CalmRule rule;
  rule.linear_speed = 0.2;
  rule.settle = 0;
  rule.window = 0.1;
  rule.every = 0.1;
  const HeldRecording recording = read_held_recording(file_, rule, "sent", false);
  EXPECT_GT(recording.samples.size(), 80u);
}

TEST_F(Recorded, SaysWhatIsMissing) {
  write(2, false);
  EXPECT_THROW(read_held_recording(file_, {}, "sent", false), std::runtime_error);
  write(2);
  CalmRule rule;
  rule.settle = 5;
  EXPECT_THROW(read_held_recording(file_, rule, "sent", false), std::runtime_error);
}

}  // namespace
}  // namespace palpate::fit
