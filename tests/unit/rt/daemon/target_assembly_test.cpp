// Targets of many points, over the bus: chunks that are lost, repeated and out of order.
#include "rt/daemon/target_assembly.hpp"

#include <gtest/gtest.h>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

constexpr int kPoints = 150;  // three chunks

/// In two rows along the bar's upper side.
std::string feature() {
  std::string points;
  for (int i = 0; i < kPoints; ++i)
    points += std::string(i == 0 ? "" : ", ") + "[" + std::to_string(0.005 + 0.0065 * (i / 2)) +
              (i % 2 == 0 ? ", 0.015" : ", 0.045") + ", 0.06]";
  return "feature={component: points, rest_points: [" + points + "]}";
}

class LargeTargets : public ::testing::Test {
 protected:
  LargeTargets() {
    bus_->start();
    bus::record(*hub_, &published_);
  }
  ~LargeTargets() override { bus::record(*hub_, nullptr); }

  /// Every point of the feature `up` m above its rest position.
  std::vector<shape_target_t> chunks_of(int revision, double up) const {
    const std::vector<Eigen::Vector3d>& rest = daemon_->pipeline().feature().rest_points();
    std::vector<shape_target_t> chunks(3);
    for (int i = 0; i < kPoints; ++i) {
      shape_target_t& chunk = chunks[static_cast<std::size_t>(i / 64)];
      const Eigen::Vector3d goal =
          rest[static_cast<std::size_t>(i)] + up * Eigen::Vector3d::UnitZ();
      for (int axis = 0; axis < 3; ++axis) {
        chunk.rest_points[i % 64][axis] = rest[static_cast<std::size_t>(i)][axis];
        chunk.values[3 * (i % 64) + axis] = goal[axis];
      }
      chunk.point_count = i % 64 + 1;
      chunk.value_count = 3 * chunk.point_count;
    }
    for (int c = 0; c < 3; ++c) {
      shape_target_t& chunk = chunks[static_cast<std::size_t>(c)];
      chunk.session = 7;
      chunk.revision = revision;
      chunk.chunk = static_cast<std::int16_t>(c);
      chunk.chunks = 3;
      bus::put_text(chunk.kind, "points");
    }
    return chunks;
  }
  void send(const shape_target_t& chunk) {
    bus::TypedPublisher<shape_target_t>(*sender_, "SHAPE_TARGET").publish(chunk);
    run(1);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now_ns_ += 1'000'000;
      daemon_->tick({now_ns_, now_ns_ / 1000, 0});
    }
  }
  /// Answers so far: "target", or "refused: why".
  std::vector<std::string> answers() {
    run(2);
    std::vector<std::string> found;
    for (const bus::Published& p : published_) {
      if (p.channel != "COMPONENT_EVENT") continue;
      component_event_t event;
      event.decode(p.data.data(), 0, static_cast<int>(p.data.size()));
      const std::string name = bus::get_text(event.event), reason = bus::get_text(event.reason);
      if (name == "target" || name == "refused")
        found.push_back(name + (reason.empty() ? "" : ": " + reason));
    }
    return found;
  }
  double target_above_rest() const {
    const Eigen::VectorXd& value = daemon_->pipeline().target().value;
    const std::vector<Eigen::Vector3d>& rest = daemon_->pipeline().feature().rest_points();
    EXPECT_EQ(value.size(), 3 * kPoints);
    double up = value[2] - rest[0].z();
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d goal = value.segment<3>(3 * i);
      EXPECT_LT((goal - rest[static_cast<std::size_t>(i)] - up * Eigen::Vector3d::UnitZ()).norm(),
                1e-12)
          << i;
    }
    return up;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> sender_ = bus::make_memory_bus(hub_);
  std::unique_ptr<Daemon> daemon_ = std::make_unique<Daemon>(
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                              {feature()}),
      *bus_, *bus_, Mode::kDeterministic, 1);
  std::vector<bus::Published> published_;
  std::int64_t now_ns_ = 0;
};

TEST_F(LargeTargets, AreWholeOnceEveryChunkHasCome) {
  const std::vector<shape_target_t> chunks = chunks_of(1, 0.01);
  send(chunks[2]);
  send(chunks[2]);  // repeated
  send(chunks[0]);  // out of order; the middle one is lost
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(daemon_->pipeline().target().revision, -1) << "half a target is none";
  for (const int again : {0, 1, 2}) send(chunks[static_cast<std::size_t>(again)]);
  EXPECT_EQ(answers(), std::vector<std::string>{"target"});
  EXPECT_EQ(daemon_->pipeline().target().revision, 1);
  EXPECT_NEAR(target_above_rest(), 0.01, 1e-12);
  for (const shape_target_t& chunk : chunks) send(chunk);  // as at 2 Hz
  EXPECT_EQ(answers().size(), 1u);
}

TEST_F(LargeTargets, OfAnotherRevisionAreNotMixed) {
  const std::vector<shape_target_t> old = chunks_of(1, 0.01), now = chunks_of(2, 0.02);
  send(old[0]);
  send(old[1]);
  send(now[2]);
  send(old[2]);  // late: of an abandoned target
  EXPECT_TRUE(answers().empty());
  send(now[1]);
  send(now[0]);
  EXPECT_EQ(answers(), std::vector<std::string>{"target"});
  EXPECT_EQ(daemon_->pipeline().target().revision, 2);
  EXPECT_NEAR(target_above_rest(), 0.02, 1e-12);
}

TEST_F(LargeTargets, BurstsOfAllChunksFitTheQueue) {
  for (const shape_target_t& chunk : chunks_of(1, 0.01))
    bus::TypedPublisher<shape_target_t>(*sender_, "SHAPE_TARGET").publish(chunk);
  EXPECT_EQ(answers(), std::vector<std::string>{"target"});
}

TEST_F(LargeTargets, ThatCannotBeAreRefusedOnce) {
  std::vector<shape_target_t> chunks = chunks_of(1, 0.01);
  chunks[1].point_count = 63;  // where is the other one?
  for (int times = 0; times < 2; ++times)
    for (const shape_target_t& chunk : chunks) send(chunk);
  chunks = chunks_of(2, 0.01);
  bus::put_text(chunks[2].kind, "point");
  for (const shape_target_t& chunk : chunks) send(chunk);
  chunks = chunks_of(3, 0.01);
  chunks[0].chunks = TargetAssembly::kMostChunks + 1;
  send(chunks[0]);
  chunks = chunks_of(4, 0.01);
  chunks[0].chunk = 3;
  send(chunks[0]);
  chunks = chunks_of(5, 0.01);
  chunks[0].value_count = 193;
  send(chunks[0]);
  chunks = chunks_of(6, 0.01);
  for (shape_target_t& chunk : chunks) chunk.chunks = 2;  // a complete target with too few points
  send(chunks[0]);
  chunks[1].point_count = chunks[1].value_count = 0;
  send(chunks[1]);
  const std::vector<std::string> replies = answers();
  const std::vector<std::string> causes = {
      "full", "chunks of one target", "too many chunks", "too many chunks", "counts", ""};
  ASSERT_EQ(replies.size(), causes.size());
  for (std::size_t i = 0; i < replies.size(); ++i) {
    EXPECT_EQ(replies[i].find("refused: "), 0u) << replies[i];
    EXPECT_NE(replies[i].find(causes[i]), std::string::npos) << replies[i];
  }
  EXPECT_EQ(daemon_->pipeline().target().revision, -1);
}

}  // namespace
}  // namespace palpate::daemon
