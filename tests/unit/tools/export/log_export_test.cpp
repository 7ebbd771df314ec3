#include "tools/export/log_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>

#include "tests/support/scratch_folder.hpp"
#include "tools/log/event_log.hpp"
#include "tools/log/merged_log.hpp"

namespace palpate::exporting {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // us

/// Two logs, a quarter of a second apart: FT_WRENCH with sequence numbers 0, 1, 2 and IMU with 0,
/// 1, once a second each, and an event of an unknown type at the end of the second.
class LogExport : public ::testing::Test {
 protected:
  LogExport() {
    log::EventLog first(path("first.log")), second(path("second.log"));
    ft_wrench_t wrench{};
    imu_t imu{};
    for (int i = 0; i < 3; ++i) {
      wrench.seq = imu.seq = i;
      first.write("FT_WRENCH", kBegin + i * 1'000'000, wrench);
      if (i < 2) second.write("IMU", kBegin + i * 1'000'000 + 250'000, imu);
    }
    std::vector<std::uint8_t> unknown = {1, 2, 3};
    second.write("STRANGE", kBegin + 2'500'000, unknown);
    selection.logs = {path("second.log"), path("first.log")};
    selection.quiet = true;
  }

  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }

  /// Channel, time since the beginning in ms, and size of each event of the output.
  std::vector<std::string> exported() {
    const Written written = export_log(selection, path("out/out.log"));
    log::MergedLog log({written.file});
    std::vector<std::string> events;
    while (const bus::LoggedEvent* event = log.next())
      events.push_back(event->channel + " " + std::to_string((event->utime - kBegin) / 1000) + " " +
                       std::to_string(event->size));
    EXPECT_EQ(written.count, static_cast<std::int64_t>(events.size()));
    EXPECT_TRUE(log.complaints().empty());
    return events;
  }

  std::string error(const std::filesystem::path& output) {
    try {
      export_log(selection, output);
    } catch (const std::runtime_error& wrong) {
      return wrong.what();
    }
    return "";
  }

  support::ScratchFolder folder;
  LogSelection selection;
};

std::string wrench_at(int ms) {
  return "FT_WRENCH " + std::to_string(ms) + " " + std::to_string(ft_wrench_t{}.getEncodedSize());
}

std::string imu_at(int ms) {
  return "IMU " + std::to_string(ms) + " " + std::to_string(imu_t{}.getEncodedSize());
}

TEST_F(LogExport, MergesByTimeAndKeepsUnknownTypes) {
  EXPECT_THAT(exported(), ElementsAre(wrench_at(0), imu_at(250), wrench_at(1000), imu_at(1250),
                                      wrench_at(2000), "STRANGE 2500 3"));
}

TEST_F(LogExport, CutsByTheTimeSinceTheFirstEventOfAllLogs) {
  selection.from = 0.25;
  selection.to = 1.2;
  EXPECT_THAT(exported(), ElementsAre(imu_at(250), wrench_at(1000)));
}

TEST_F(LogExport, FiltersChannelsByPatterns) {
  selection.channels = {"*M*", "S*"};
  selection.without = {"STRANG?"};
  EXPECT_THAT(exported(), ElementsAre(imu_at(250), imu_at(1250)));
}

TEST_F(LogExport, ErrorsLeaveNoFileAndNoLogIsOverwritten) {
  EXPECT_THAT(error(path("first.log")), HasSubstr("first.log: is one of the logs"));
  selection.channels = {"IMU_1"};
  EXPECT_EQ(error(path("out.log")),
            "no channel 'IMU_1' in the logs; they have: FT_WRENCH, IMU, STRANGE");
  selection.channels.clear();
  selection.from = 3;
  EXPECT_EQ(error(path("out.log")), "no event of the logs is selected");
  EXPECT_FALSE(std::filesystem::exists(path("out.log")));
  EXPECT_FALSE(std::filesystem::exists(path("out.log.part")));
}

}  // namespace
}  // namespace palpate::exporting
