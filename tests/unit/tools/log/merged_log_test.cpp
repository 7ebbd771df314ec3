#include "tools/log/merged_log.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/export/log_writer.hpp"

namespace palpate::log {
namespace {

class MergedLogTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::vector<std::int64_t>& times) {
    const auto file = folder_.path() / name;
    exporting::LogWriter writer(file);
    for (const std::int64_t time : times) writer.write(name, time, ft_wrench_t{});
    return file;
  }

  static std::vector<std::pair<std::int64_t, std::string>> all(MergedLog& log) {
    std::vector<std::pair<std::int64_t, std::string>> events;
    while (const bus::LoggedEvent* event = log.next())
      events.emplace_back(event->utime, event->channel);
    return events;
  }

  support::ScratchFolder folder_;
};

TEST_F(MergedLogTest, EventsComeByTime) {
  MergedLog log({write("A", {10, 20, 20, 50}), write("B", {5, 20, 60})});
  const std::vector<std::pair<std::int64_t, std::string>> expected{
      {5, "B"}, {10, "A"}, {20, "A"}, {20, "A"}, {20, "B"}, {50, "A"}, {60, "B"}};
  EXPECT_EQ(all(log), expected);
  EXPECT_EQ(log.place(), log.size());
  EXPECT_TRUE(log.complaints().empty());
  log.rewind();
  EXPECT_EQ(log.place(), 0);
  EXPECT_EQ(all(log), expected);
}

TEST_F(MergedLogTest, AnEmptyLogIsNoObstacle) {
  MergedLog log({write("A", {}), write("B", {1})});
  EXPECT_EQ(all(log).size(), 1u);
}

TEST_F(MergedLogTest, OfACutAndADamagedLogTheRestIsReadAndThePlaceReported) {
  const auto file = write("A", {1, 2, 3, 4});
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(file)), one = size / 4;
  {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(one);  // the second event's sync word
    bytes.write("????", 4);
  }
  std::filesystem::resize_file(file, static_cast<std::uintmax_t>(size - 7));
  MergedLog log({file});
  // The first event is not followed by another one, and is therefore not accepted either.
  const auto events = all(log);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].first, 3);
  ASSERT_EQ(log.complaints().size(), 1u);
  const std::string complaint = log.complaints()[0];
  EXPECT_NE(complaint.find(file.string()), std::string::npos);
  EXPECT_NE(complaint.find("the first at byte 0"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("the last event is cut short"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("1 events could be read, the last of them ends at byte " +
                           std::to_string(3 * one) + " of " + std::to_string(size - 7)),
            std::string::npos)
      << complaint;
}

TEST_F(MergedLogTest, WhatIsNoLogIsAnError) {
  const auto file = folder_.path() / "text";
  std::ofstream(file) << std::string(100, 'x');
  MergedLog log({file});
  EXPECT_THROW(log.next(), std::runtime_error);
  EXPECT_THROW(MergedLog({folder_.path() / "none"}), std::runtime_error);
  EXPECT_THROW(MergedLog({}), std::runtime_error);
}

}  // namespace
}  // namespace palpate::log
