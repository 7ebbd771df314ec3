#include "tools/record/recorder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <palpate/ft_wrench_t.hpp>
#include <thread>

#include "rt/bus/event_log_reader.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::record {
namespace {

class RecorderTest : public testing::Test {
 protected:
  RecorderOptions options() const {
    RecorderOptions options;
    options.labels = {"control", "housekeeping"};
    options.name = path("run.lcmlog");
    options.min_free_mb = 0;
    return options;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  static std::vector<std::uint8_t> wrench(int number) {
    ft_wrench_t message{};
    message.seq = number;
    message.session = 4;
    return bus::wire::encoded(message);
  }
  static void take(Recorder& recorder, int source, const std::string& channel,
                   const std::vector<std::uint8_t>& data, std::int64_t utime) {
    recorder.take(
        {source, utime, 1000 * utime, channel, data.data(), static_cast<int>(data.size())});
  }
  static std::vector<std::string> channels_in(const std::string& file) {
    std::vector<std::string> channels;
    bus::EventLogReader log(file);
    while (const bus::LoggedEvent* event = log.next()) channels.push_back(event->channel);
    EXPECT_EQ(log.complaint(), "");
    return channels;
  }

  support::ScratchFolder folder_;
};

using Names = std::vector<std::string>;

TEST_F(RecorderTest, EachUrlHasALog) {
  Recorder recorder(options());
  take(recorder, 0, "FT_WRENCH", wrench(1), 1'000'000);
  take(recorder, 1, "HEALTH", {1, 2, 3}, 1'100'000);
  take(recorder, 0, "FT_WRENCH", wrench(4), 2'000'000);
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.control.lcmlog")), (Names{"FT_WRENCH", "FT_WRENCH"}));
  EXPECT_EQ(channels_in(path("run.housekeeping.lcmlog")), Names{"HEALTH"});
  const std::vector<ChannelSummary> channels = recorder.channels();
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[0].type, "ft_wrench_t");
  EXPECT_EQ(channels[0].lost, 2);
  EXPECT_EQ(channels[0].senders, 1);
  EXPECT_EQ(channels[0].messages, 2);
  EXPECT_EQ(channels[1].type, "");
  EXPECT_EQ(recorder.totals().lost, 2);
}

TEST_F(RecorderTest, OneLogForAllUrlsOnRequest) {
  RecorderOptions merged = options();
  merged.merge = true;
  Recorder recorder(merged);
  take(recorder, 0, "FT_WRENCH", wrench(1), 1);
  take(recorder, 1, "HEALTH", {1}, 2);
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.lcmlog")), (Names{"FT_WRENCH", "HEALTH"}));
}

TEST_F(RecorderTest, LeavesOutWhatIsNotWanted) {
  RecorderOptions some = options();
  some.channels = "FT_.*|BROKEN";
  some.known_only = true;
  Recorder recorder(some);
  take(recorder, 0, "FT_WRENCH", wrench(1), 1);
  take(recorder, 0, "IMU", wrench(1), 2);
  std::vector<std::uint8_t> broken = wrench(1);
  broken.pop_back();
  take(recorder, 0, "BROKEN", broken, 3);
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.control.lcmlog")), Names{"FT_WRENCH"});
  EXPECT_EQ(recorder.totals().misfits, 1);
}

TEST_F(RecorderTest, EndsWhenTheDiskIsNearlyFullAndKeepsWhatItHas) {
  RecorderOptions careful = options();
  careful.min_free_mb = 100;
  std::int64_t left = 200'000'000;
  Recorder recorder(careful, [&](const std::string& folder) {
    EXPECT_EQ(folder, folder_.path().string());
    return left;
  });
  take(recorder, 0, "FT_WRENCH", wrench(1), 1);
  std::int64_t now_ns = 10'000'000'000;
  EXPECT_TRUE(recorder.write(now_ns));
  left = 99'000'000;
  EXPECT_TRUE(recorder.write(now_ns + 10'000'000)) << "it looks once a second";
  EXPECT_FALSE(recorder.write(now_ns + 1'000'000'000));
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.control.lcmlog")), Names{"FT_WRENCH"});
}

TEST_F(RecorderTest, DoesNotBeginOnAFullDisk) {
  RecorderOptions careful = options();
  careful.min_free_mb = 100;
  EXPECT_THROW(Recorder(careful, [](const std::string&) { return std::int64_t{50'000'000}; }),
               std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << "no file is left behind";
}

TEST_F(RecorderTest, DropsAndCountsWhatTheDiskDoesNotKeepUpWith) {
  RecorderOptions small = options();
  small.max_unwritten_mb = 0.01;
  Recorder recorder(small);
  const std::vector<std::uint8_t> data(1000 - 128);
  for (int i = 0; i < 25; ++i) take(recorder, 0, "LARGE", data, i);
  EXPECT_EQ(recorder.totals().unwritten, 15);
  EXPECT_EQ(recorder.totals().messages, 10);
  EXPECT_TRUE(recorder.write(1));
  take(recorder, 0, "LARGE", data, 26);
  EXPECT_EQ(recorder.totals().unwritten, 15) << "there is room again";
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.control.lcmlog")).size(), 11u);
}

TEST_F(RecorderTest, NamesDrawnAtRandomFillNoMemory) {
  Recorder recorder(options());
  for (int i = 0; i < 10'000; ++i) {
    take(recorder, 0, "N" + std::to_string(i), {1}, i);
    if (i % 1000 == 0) recorder.write(i);
  }
  recorder.finish();
  EXPECT_LE(recorder.channels().size(), 4097u);
  EXPECT_EQ(recorder.totals().messages, 10'000);
  EXPECT_EQ(channels_in(path("run.control.lcmlog")).size(), 10'000u) << "but all are recorded";
}

TEST_F(RecorderTest, TakesInOneThreadAndWritesInAnother) {
  Recorder recorder(options());
  constexpr int kCount = 20'000;
  std::thread receiver([&] {
    for (int i = 0; i < kCount; ++i) take(recorder, i % 2, "FT_WRENCH", wrench(i), i);
  });
  for (int i = 0; i < 100; ++i) recorder.write(i * 20'000'000);
  receiver.join();
  recorder.finish();
  EXPECT_EQ(channels_in(path("run.control.lcmlog")).size() +
                channels_in(path("run.housekeeping.lcmlog")).size(),
            static_cast<std::size_t>(kCount));
}

}  // namespace
}  // namespace palpate::record
