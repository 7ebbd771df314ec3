#include "tools/lab/fit_check/simulated.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"
#include "tools/fit/held/held_log.hpp"

namespace palpate::fit_check {
namespace {

/// A coarse bar that is pulled by 8 mm within 0.2 s.
SimulatedRecording short_pull() {
  SimulatedRecording recording;
  recording.scene = PALPATE_SOURCE_DIR "/tools/lab/fit_check/bar_rests.yaml";
  recording.overrides = {"object.elements=[7, 1, 1]", "object.grasp_box.lower=[0.428, 0, 0]",
                         "object.pads.stiffness=1e4",
                         "motion={start_delay: 0.1, poses: [{move: 0.2, hold: 0.2, translation: "
                         "[0.008, 0, 0]}]}"};
  recording.markers = {{0.2, 0, 0.03}, {0.2, 0.06, 0.03}};
  return recording;
}

TEST(SimulatedRecording, HoldsHandWrenchAndMarkers) {
  const support::ScratchFolder folder;
  const std::string file = (folder.path() / "pull.log").string();
  SimulatedRecording recording = short_pull();
  recording.noise = 0;
  record(recording, file);
  const fit::HeldLog log = fit::read_held_log(file, {}, "sent");
  EXPECT_NEAR(log.robot.size(), 250, 5);
  EXPECT_NEAR(log.wrenches.size(), 500, 5);
  ASSERT_NEAR(log.seen.size(), 50, 2);
  EXPECT_EQ(log.seen[0].count, 2);
  const Eigen::Map<const Eigen::Vector3d> first(log.robot.front().position),
      last(log.robot.back().position);
  EXPECT_NEAR((last - first).norm(), 0.008, 0.002);
  // The clamp is 0.2 m away, the hand about 0.23 m: the marker moves slightly less than half as
  // far.
  const auto marker = [&](const shape_observation_t& seen) {
    return Eigen::Vector3f(seen.points[0][0], seen.points[0][1], seen.points[0][2]);
  };
  EXPECT_NEAR((marker(log.seen.back()) - marker(log.seen.front())).norm(), 0.0035, 0.0015);
}

TEST(SimulatedRecording, NoiseIsThatShareOfTheGreatest) {
  const support::ScratchFolder folder;
  const std::string file = (folder.path() / "pull.log").string();
  record(short_pull(), file);
  const fit::HeldLog log = fit::read_held_log(file, {}, "sent");
  EXPECT_NEAR(log.seen[0].deviation, 0.01 * 0.0035, 2e-5);
  // Relative to the pair's distance, 0.06 m, in each message; the bar thins by 0.3 mm at most.
  double squares = 0;
  for (const shape_observation_t& seen : log.seen) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis)
      squared += std::pow(seen.points[0][axis] - seen.points[1][axis], 2);
    squares += std::pow(std::sqrt(squared) - 0.06, 2) / static_cast<double>(log.seen.size());
  }
  EXPECT_GT(squares, 0);
  EXPECT_LT(std::sqrt(squares), 4e-4);
}

TEST(SimulatedRecording, NeedsAMotion) {
  SimulatedRecording recording = short_pull();
  recording.scene = PALPATE_SOURCE_DIR "/sim/scenes/bar_long_soft_control.yaml";
  recording.overrides.pop_back();
  EXPECT_THROW(record(recording, "unused.log"), std::runtime_error);
}

}  // namespace
}  // namespace palpate::fit_check
