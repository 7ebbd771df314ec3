#include "tools/log/log_reader.hpp"

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <palpate/health_v1_t.hpp>
#include <palpate/shape_mesh_v1_t.hpp>
#include <palpate/shape_v1_t.hpp>
#include <stdexcept>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/lab/scores/synthetic_run.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::log {
namespace {

template <class Message>
void write(lcm::LogFile& log, const std::string& channel, std::int64_t timestamp,
           const Message& message) {
  std::vector<std::uint8_t> data(message.getEncodedSize());
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  lcm::LogEvent event = {};
  event.timestamp = timestamp;
  event.channel = channel;
  event.datalen = static_cast<int>(data.size());
  event.data = data.data();
  log.writeEvent(&event);
}

TEST(LogReader, MessagesTakeTheTimeOfTheLogAndStrangersAreSkipped) {
  const support::ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "one.log";
  {
    lcm::LogFile log(file.string(), "w");
    twist_command_t command = {};
    command.utime = 5;  // a separate clock
    command.twist[2] = 0.25;
    write(log, "TWIST_COMMAND", 1000, command);
    write(log, "TWIST_COMMAND", 2000, shape_t{});
    write(log, "HEALTH", 3000, health_t{});
  }
  LogReader reader;
  std::vector<twist_command_t> commands;
  reader.collect("TWIST_COMMAND", commands);
  reader.read(file);
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands[0].utime, 1000);
  EXPECT_EQ(commands[0].twist[2], 0.25);
  EXPECT_EQ(reader.undecodable(), 1);
  EXPECT_EQ(reader.events(), 3);
}

TEST(LogReader, InLockStepSendersAgreeButForTheOneOfTargets) {
  const support::ScratchFolder scratch;
  const std::filesystem::path control = scratch.path() / "control.log",
                              slow = scratch.path() / "housekeeping.log";
  {
    lcm::LogFile log(control.string(), "w");
    shape_target_t target = {};
    target.utime = 777;  // a separate clock
    target.revision = 1;
    feature_t feature = {};
    feature.revision = -1;
    feature.utime = 10;
    write(log, "SHAPE_TARGET", 5000, target);
    write(log, "FEATURE", 5000, feature);
    feature.revision = 1;
    for (feature.utime = 20; feature.utime < 50; feature.utime += 10)
      write(log, "FEATURE", 5001, feature);
    discrepancy_t discrepancy = {};
    for (discrepancy.utime = 60; discrepancy.utime > 30; discrepancy.utime -= 20)
      write(log, "DISCREPANCY", 5001, discrepancy);
    lcm::LogFile other(slow.string(), "w");
    write(other, "SHAPE", 5002, scores::shape_at(30e-6, Eigen::Matrix3Xd::Zero(3, 4), 1));
  }
  const RunLog run = read_run(control, slow, LogClock::kSent);
  ASSERT_EQ(run.targets.size(), 1u);
  EXPECT_EQ(run.targets[0].utime, 20);
  ASSERT_EQ(run.shapes.size(), 1u);
  EXPECT_EQ(run.shapes[0].utime, 30);
  EXPECT_EQ(run.features.size(), 4u);
  ASSERT_EQ(run.discrepancies.size(), 2u);
  EXPECT_EQ(run.discrepancies[0].utime, 40) << "in order of sending";
}

TEST(LogReader, OfALogThatIsCutShortTheRestIsReadWithAWarning) {
  const support::ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "one.log";
  {
    lcm::LogFile log(file.string(), "w");
    for (int i = 0; i < 3; ++i) write(log, "TWIST_COMMAND", 1000 * i, twist_command_t{});
  }
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  LogReader reader;
  std::vector<twist_command_t> commands;
  reader.collect("TWIST_COMMAND", commands);
  testing::internal::CaptureStderr();
  reader.read(file);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "warning: " + file.string() + ": the last event is cut short\n");
  EXPECT_EQ(commands.size(), 2u);
}

TEST(LogReader, BySendersClockWhatWasOvertakenIsBackInItsPlace) {
  const support::ScratchFolder scratch;
  const auto control = scratch.path() / "overtaken.log";
  {
    lcm::LogFile log(control.string(), "w");
    feature_t feature = {};
    for (const int seq : {1, 2, 5, 3, 4, 7, 6}) {
      feature.seq = seq;
      feature.utime = 1000 * (seq / 2);  // two of each time
      write(log, "FEATURE", 5000 + seq, feature);
    }
  }
  const RunLog sent = read_run(control, control, LogClock::kSent);
  const RunLog received = read_run(control, control);
  ASSERT_EQ(sent.features.size(), 7u);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(sent.features[i].seq, i + 1);
  EXPECT_EQ(received.features.back().seq, 6);
}

TEST(LogReader, ALogOfFormerTypesIsReadAsAWhole) {
  const support::ScratchFolder scratch;
  const std::filesystem::path path = scratch.path() / "former.log";
  const std::vector<float> nodes = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  {
    shape_mesh_v1_t mesh{};
    mesh.mesh_hash = 77;
    mesh.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
    mesh.chunks = 1;
    mesh.corner_count = 4;
    mesh.rest_xyz = nodes;
    mesh.rest_xyz_count = 12;
    mesh.element_size = 4;
    mesh.elements = {0, 1, 2, 3};
    mesh.element_index_count = 4;
    mesh.triangles = {0, 2, 1};
    mesh.triangle_index_count = 3;
    shape_v1_t shape{};
    shape.mesh_hash = 77;
    shape.node_count = 4;
    shape.xyz = nodes;
    shape.xyz_count = 12;
    health_v1_t health{};
    health.gate_refused = 9;
    lcm::LogFile log(path.string(), "w");
    write(log, "SHAPE_MESH", 1, mesh);
    write(log, "SHAPE", 2, shape);
    write(log, "HEALTH", 3, health);
  }
  const RunLog run = read_run(path, path);
  const MeshMessage mesh = assemble(run.shape_chunks);
  EXPECT_EQ(mesh.nodes.cols(), 4);
  ASSERT_EQ(run.shapes.size(), 1u);
  EXPECT_EQ(run.shapes[0].utime, 2) << "time of the log";
  EXPECT_EQ(positions(run.shapes[0]), mesh.nodes);
  ASSERT_EQ(run.health.size(), 1u);
  EXPECT_EQ(run.health[0].gate_rejected, 9);
}

TEST(LogReader, AFileThatIsAbsentIsAnError) {
  EXPECT_THROW(LogReader().read("/nonexistent/run.log"), std::runtime_error);
}

}  // namespace
}  // namespace palpate::log
