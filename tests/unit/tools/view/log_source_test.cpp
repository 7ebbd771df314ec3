#include "tools/view/log_source.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "rt/bus/text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/view/shapes.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::view {
namespace {

constexpr std::int64_t kBegin = 1'600'000'000'000'000;  // us

/// Ten seconds: a shape every 10 ms whose node 0 encodes the time, HEALTH, three events, and the
/// mesh late, as is permitted.
class LogSourceTest : public ::testing::Test {
 protected:
  /// Chunks of the same time of sending, within the interval at which a log is indexed.
  static void write_in_two(log::EventLog& log, const shape_t& shape) {
    shape_t chunk = shape;
    chunk.chunks = 2;
    chunk.xyz.resize(3);
    chunk.xyz_count = 3;
    log.write("SHAPE", shape.utime, chunk);
    chunk.chunk = 1;
    chunk.first_node = 1;
    chunk.xyz.assign(shape.xyz.begin() + 3, shape.xyz.end());
    chunk.xyz_count = shape.xyz_count - 3;
    log.write("SHAPE", shape.utime, chunk);
  }

  LogSourceTest() {
    const auto mesh = box_mesh({2, 1, 1});
    log::EventLog log(control_), housekeeping(housekeeping_);
    for (int i = 0; i <= 1000; ++i) {
      shape_t shape = shape_of(*mesh, [](const Eigen::Vector3f& x) { return x; });
      shape.xyz[0] = 0.01F * static_cast<float>(i);
      shape.utime = kBegin + i * 10'000;
      write_in_two(housekeeping, shape);
      feature_t feature{};
      feature.revision = 1;
      feature.error_count = 1;
      feature.error[0] = i == 500 ? 0.5 : 0.01;
      log.write("FEATURE", kBegin + i * 10'000, feature);
      discrepancy_t discrepancy{};
      discrepancy.test = i < 100 ? -1 : 1e-3 * i;
      discrepancy.threshold = 0.9;
      discrepancy.inconsistent = i > 900 ? 1 : 0;
      if (i % 5 == 0) log.write("DISCREPANCY", kBegin + i * 10'000, discrepancy);
      if (i == 700) housekeeping.write("SHAPE_MESH", kBegin + i * 10'000, *box_mesh({2, 1, 1}));
      if (i % 400 == 0) {
        component_event_t event{};
        bus::put_text(event.event, "event" + std::to_string(i));
        housekeeping.write("COMPONENT_EVENT", kBegin + i * 10'000, event);
      }
    }
  }
  std::unique_ptr<LogSource> open() {
    return std::make_unique<LogSource>(
        std::vector<std::string>{control_, housekeeping_}, [](const std::string&, double) {},
        complaints_);
  }

  support::ScratchFolder folder_;
  std::string control_ = (folder_.path() / "control.log").string();
  std::string housekeeping_ = (folder_.path() / "housekeeping.log").string();
  std::vector<std::string> complaints_;
};

TEST_F(LogSourceTest, ShowsAnyTimeForwardsAndBack) {
  const auto log = open();
  EXPECT_NEAR(log->duration(), 10, 1e-9);
  Scene scene;
  log->go_to(0, scene);
  for (const double time : {0.0, 3.333, 9.999, 10.0, 1.001, 8.0, 7.99, -5.0, 99.0}) {
    log->go_to(time, scene);
    scene.refresh();
    const double shown = std::min(std::max(time, 0.0), 10.0);
    ASSERT_NE(scene.shape.get(), nullptr);
    EXPECT_NEAR(scene.shape.get()->xyz[0], std::floor(shown * 100 + 1e-6) / 100, 1e-5) << time;
    EXPECT_NE(scene.meshes().find(77), nullptr) << "from the start on";
    EXPECT_EQ(scene.events().size(), static_cast<std::size_t>(1 + shown / 4)) << time;
  }
}

TEST_F(LogSourceTest, ShowsEachObstacleAtAnyTime) {
  {
    log::EventLog log(control_);
    world_state_t message{};
    message.quaternion[0] = 1;
    for (int i = 0; i <= 100; ++i) {  // two obstacles at the same time
      message.utime = kBegin + i * 10'000;
      message.position[0] = i;
      bus::put_text(message.name, "plate");
      log.write("WORLD_STATE", message.utime, message);
      message.position[0] = -i;
      bus::put_text(message.name, "lid");
      if (i < 50) log.write("WORLD_STATE", message.utime, message);
    }
  }
  const auto log = open();
  Scene scene;
  for (const int i : {0, 70, 20, 100}) {
    log->go_to(0.01 * i + 0.001, scene);
    ASSERT_NE(scene.moved("plate"), nullptr) << i;
    EXPECT_EQ(scene.moved("plate")->message.position[0], i);
    ASSERT_NE(scene.moved("lid"), nullptr) << i;
    EXPECT_EQ(scene.moved("lid")->message.position[0], -std::min(i, 49));
    EXPECT_EQ(scene.moved("lid")->time_us, kBegin + std::min(i, 49) * 10'000);
  }
}

TEST_F(LogSourceTest, SummarisesTheWholeInSeries) {
  const auto log = open();
  const Series& error = log->series().at(0);
  ASSERT_EQ(error.value.size(), 1001U);
  EXPECT_FLOAT_EQ(error.value[500], 0.5F);
  EXPECT_NEAR(error.time_s[500], 5, 1e-3);
  const Series &test = log->series().at(3), &threshold = log->series().at(4),
               &contradiction = log->series().at(5);
  ASSERT_EQ(test.value.size(), 181U) << "without those before the first test";
  EXPECT_FLOAT_EQ(test.value[0], 0.1F);
  EXPECT_NEAR(test.time_s[0], 1, 1e-3);
  EXPECT_EQ(threshold.time_s, test.time_s);
  ASSERT_EQ(contradiction.value.size(), 20U);
  EXPECT_FLOAT_EQ(contradiction.value[0], 0.905F);
  ASSERT_EQ(log->marks().size(), 3U);
  EXPECT_NEAR(log->marks()[1].first, 4, 1e-6);
  EXPECT_EQ(log->marks()[2].second, "event800");
}

TEST_F(LogSourceTest, ReadsWhatIsLeftOfALogThatWasCutShort) {
  std::filesystem::resize_file(housekeeping_, std::filesystem::file_size(housekeeping_) / 2);
  const auto log = open();
  ASSERT_EQ(complaints_.size(), 1U);
  EXPECT_NE(complaints_[0].find(housekeeping_), std::string::npos);
  Scene scene;
  log->go_to(2, scene);
  scene.refresh();
  EXPECT_NEAR(scene.shape.get()->xyz[0], 2, 1e-5);
}

TEST_F(LogSourceTest, SaysWhenThereIsNothingToShow) {
  const std::string other = (folder_.path() / "other.log").string();
  log::EventLog(other).write("FT_WRENCH", kBegin, health_t{});
  const auto fail = [&](const std::string& path) {
    try {
      LogSource log(
          {path}, [](const std::string&, double) {}, complaints_);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(fail(other).find("no message to be shown"), std::string::npos);
  EXPECT_NE(fail((folder_.path() / "none.log").string()).find("none.log"), std::string::npos);
}

}  // namespace
}  // namespace palpate::view
