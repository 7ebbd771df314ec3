#include "tools/record/log_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <sstream>

#include "tests/support/scratch_folder.hpp"

namespace palpate::record {
namespace {

namespace fs = std::filesystem;

class LogFilesTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string name() const { return path("run.lcmlog"); }
  static std::string text_of(const std::string& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  void put(const std::string& file, const std::string& text) const {
    std::ofstream(path(file)) << text;
  }
  /// Times of the events, by liblcm's own reader.
  static std::vector<std::int64_t> times_of(const std::string& file) {
    std::vector<std::int64_t> times;
    lcm::LogFile log(file, "r");
    while (log.good()) {
      const lcm::LogEvent* event = log.readNextEvent();
      if (event == nullptr) break;
      times.push_back(event->timestamp);
    }
    return times;
  }
  static void write(LogFiles& log, std::int64_t from, std::int64_t to, int size = 100) {
    const std::vector<std::uint8_t> data(static_cast<std::size_t>(size), 7);
    for (std::int64_t i = from; i < to; ++i) log.write(i, "CHANNEL", data.data(), size);
  }

  support::ScratchFolder folder_;
};

TEST_F(LogFilesTest, LcmReadsWhatIsWritten) {
  LogFiles log(name(), {});
  const std::uint8_t data[] = {1, 2, 3};
  log.write(123'456'789'012, "FT_WRENCH", data, 3);
  log.write(123'456'789'013, "EMPTY", data, 0);
  log.close();
  lcm::LogFile read(name(), "r");
  const lcm::LogEvent* event = read.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->channel, "FT_WRENCH");
  EXPECT_EQ(event->timestamp, 123'456'789'012);
  ASSERT_EQ(event->datalen, 3);
  EXPECT_EQ(static_cast<const std::uint8_t*>(event->data)[2], 3);
  event = read.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->channel, "EMPTY");
  EXPECT_EQ(log.bytes(), static_cast<std::int64_t>(fs::file_size(name())));
}

TEST_F(LogFilesTest, NeverOverwritesWithoutTheOption) {
  put("run.lcmlog", "precious");
  try {
    LogFiles log(name(), {});
    FAIL() << "overwritten";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(name()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--force"), std::string::npos);
  }
  EXPECT_EQ(text_of(name()), "precious");
  LogFileOptions force;
  force.force = true;
  LogFiles log(name(), force);
  write(log, 0, 3);
  log.close();
  EXPECT_EQ(times_of(name()).size(), 3u);
}

TEST_F(LogFilesTest, IncrementTakesTheFirstNameThatIsFree) {
  put("run.lcmlog.00", "precious");
  LogFileOptions options;
  options.increment = true;
  options.split_mb = 0.002;
  LogFiles log(name(), options);
  write(log, 0, 50);  // 135 bytes each: 15 a file
  log.close();
  EXPECT_EQ(text_of(path("run.lcmlog.00")), "precious");
  std::vector<std::int64_t> all;
  for (const std::string& file : log.files()) {
    for (const std::int64_t time : times_of(file)) all.push_back(time);
  }
  EXPECT_EQ(log.files().size(), 4u);
  EXPECT_EQ(log.files().front(), path("run.lcmlog.01"));
  ASSERT_EQ(all.size(), 50u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], static_cast<std::int64_t>(i));
}

TEST_F(LogFilesTest, RotationKeepsTheNewestFiles) {
  LogFileOptions options;
  options.rotate = 3;
  options.split_mb = 0.002;
  LogFiles log(name(), options);
  write(log, 0, 15 * 5 + 4);  // six files
  log.close();
  EXPECT_EQ(times_of(path("run.lcmlog.0")), (std::vector<std::int64_t>{75, 76, 77, 78}));
  EXPECT_EQ(times_of(path("run.lcmlog.1")).front(), 60);
  EXPECT_EQ(times_of(path("run.lcmlog.2")).front(), 45);
  EXPECT_FALSE(fs::exists(path("run.lcmlog.3")));
  EXPECT_EQ(log.files(), (std::vector<std::string>{path("run.lcmlog.2"), path("run.lcmlog.1"),
                                                   path("run.lcmlog.0")}));
}

TEST_F(LogFilesTest, SplitsOnRequest) {
  LogFileOptions options;
  options.rotate = 2;
  LogFiles log(name(), options);
  write(log, 0, 2);
  log.split();
  write(log, 2, 5);
  log.close();
  EXPECT_EQ(times_of(path("run.lcmlog.1")).size(), 2u);
  EXPECT_EQ(times_of(path("run.lcmlog.0")).size(), 3u);
}

TEST_F(LogFilesTest, OptionsThatContradictEachOtherAreRefused) {
  LogFileOptions split;
  split.split_mb = 1;
  EXPECT_THROW(LogFiles(name(), split), std::invalid_argument);
  LogFileOptions both;
  both.increment = true;
  both.rotate = 2;
  EXPECT_THROW(LogFiles(name(), both), std::invalid_argument);
  EXPECT_FALSE(fs::exists(name()));
}

TEST_F(LogFilesTest, AFullDiskIsSaidWithTheFile) {
  fs::create_symlink("/dev/full", name());
  LogFileOptions force;
  force.force = true;
  LogFiles log(name(), force);
  try {
    write(log, 0, 3);
    log.flush();
    FAIL() << "/dev/full takes nothing";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(name()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("space"), std::string::npos) << error.what();
  }
}

TEST_F(LogFilesTest, AFolderThatIsNotThereIsNamed) {
  const std::string file = path("nowhere/run.lcmlog");
  try {
    LogFiles log(file, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(file), std::string::npos);
  }
}

TEST(LogNames, CarryTheLabelBeforeTheirExtension) {
  EXPECT_EQ(labelled("run", "control"), "run.control.lcmlog");
  EXPECT_EQ(labelled("run.lcmlog", "control"), "run.control.lcmlog");
  EXPECT_EQ(labelled("a.b/run.log", "control"), "a.b/run.control.log");
  EXPECT_EQ(labelled("a.b/run", "control"), "a.b/run.control.lcmlog");
}

TEST(LogNames, AreFilledInByTime) {
  EXPECT_EQ(by_time("run-%Y", 1'700'000'000), "run-2023");
  EXPECT_EQ(by_time("plain", 0), "plain");
  EXPECT_THROW(by_time("", 0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::record
