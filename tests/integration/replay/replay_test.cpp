#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <lcm/lcm-cpp.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <palpate/robot_state_t.hpp>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::replay {
namespace {

const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

/// A log in which the hand moves sideways for `seconds`; `gap`: one message in this many is lost.
class Recording {
 public:
  explicit Recording(double seconds, double amplitude = 0.03)
      : path_(std::filesystem::temp_directory_path() /
              ("palpate_replay_" + std::to_string(getpid()) + ".lcmlog")) {
    const pipeline::Pipeline pipeline(config::Node::load_file(kExample), 1e-3);
    const math::Pose X_WE0 = pipeline.frames().X_WO * pipeline.object().body.grasps[0].X_OG_rest *
                             pipeline.frames().X_EG.inverse();
    lcm::LogFile log(path_.string(), "w");
    robot_state_t state{};
    state.session = 5;
    state.joint_count = 7;
    std::vector<std::uint8_t> buffer(state.getEncodedSize());
    for (int i = 0; i < static_cast<int>(seconds * 500); ++i) {
      const double t = i * 2e-3;
      state.seq = i;
      state.utime = 1'700'000'000'000'000 + i * 2000;
      const Eigen::Vector3d p =
          X_WE0.translation() + Eigen::Vector3d(0, amplitude * std::sin(t), 0);
      for (int axis = 0; axis < 3; ++axis) state.position[axis] = p[axis];
      math::wxyz_from_rotation(X_WE0.linear(), state.quaternion);
      state.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
      lcm::LogEvent event{};
      event.timestamp = state.utime;
      event.channel = "ROBOT_STATE";
      event.datalen = static_cast<int>(buffer.size());
      event.data = buffer.data();
      log.writeEvent(&event);
    }
  }
  ~Recording() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

ReplayResult run(const Recording& recording) {
  ReplayOptions options;
  options.log = recording.path();
  options.start = true;
  return replay(config::Node::load_file(kExample), options);
}

TEST(Replay, TwoRunsOverOneLogAreBitIdentical) {
  const Recording recording(2.0);
  const ReplayResult first = run(recording);
  const ReplayResult second = run(recording);
  EXPECT_GT(first.shapes, 150);
  EXPECT_EQ(first.shapes, second.shapes);
  EXPECT_EQ(first.shape_hash, second.shape_hash);
}

TEST(Replay, AnotherMotionGivesAnotherHash) {
  const ReplayResult first = run(Recording(0.5, 0.03));
  const ReplayResult second = run(Recording(0.5, 0.02));
  EXPECT_EQ(first.shapes, second.shapes);
  EXPECT_NE(first.shape_hash, second.shape_hash);
}

TEST(Replay, ALogThatIsCutShortIsReplayedAndSaidToBe) {
  const Recording recording(0.5);
  const std::int64_t whole = run(recording).messages;
  std::filesystem::resize_file(recording.path(), std::filesystem::file_size(recording.path()) - 9);
  const ReplayResult result = run(recording);
  EXPECT_EQ(result.messages, whole - 1);
  EXPECT_EQ(result.complaint, recording.path() + ": the last event is cut short");
}

TEST(Replay, AnImpossibleTimeIsRefusedWithItsByte) {
  const Recording recording(0.1);
  constexpr int kHeader = 28, kTimeAt = 12;
  const int size =
      kHeader + static_cast<int>(std::strlen("ROBOT_STATE")) + robot_state_t().getEncodedSize();
  const auto last = static_cast<long>(std::filesystem::file_size(recording.path())) - size;
  std::fstream file(recording.path(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(last + kTimeAt + 1);
  file.put(7);  // nine years later
  file.close();
  try {
    run(recording);
    FAIL() << "the wait would take years";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(
        std::string(error.what()).find(recording.path() + ": byte " + std::to_string(last) + ": "),
        0u)
        << error.what();
  }
}

TEST(Replay, MissingLogIsNamed) {
  ReplayOptions options;
  options.log = "nowhere.lcmlog";
  try {
    replay(config::Node::load_file(kExample), options);
    FAIL() << "a missing log must be an error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.lcmlog"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::replay
