#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <stdexcept>

#include "tools/recordings/data_set.hpp"
#include "tools/recordings/recording_table.hpp"

namespace palpate::recordings {
namespace {

using ::testing::HasSubstr;

class EventLog : public ::testing::Test {
 protected:
  EventLog()
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate-log-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    file_ = std::make_unique<lcm::LogFile>(path(), "w");
  }
  ~EventLog() override { std::filesystem::remove_all(folder_); }

  std::string path() const { return (folder_ / "a.log").string(); }

  template <class Message>
  void write(const char* channel, double time, Message message) {
    message.utime = std::lround(1e6 * time);
    std::vector<std::uint8_t> bytes(message.getEncodedSize());
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm::LogEvent event{};
    event.timestamp = message.utime + 5000000;
    event.channel = channel;
    event.datalen = static_cast<int>(bytes.size());
    event.data = bytes.data();
    file_->writeEvent(&event);
  }
  void touch(double time, int pdc, int e4 = 0) {
    biotac_t message{};
    message.pdc = static_cast<std::int16_t>(pdc);
    message.electrodes[3] = static_cast<std::int16_t>(e4);
    write("BIOTAC_0", time, message);
  }
  void pull(double time, double fx) {
    ft_wrench_t message{};
    message.wrench[0] = fx;
    write("FT_WRENCH", time, message);
  }
  std::vector<Table> read(const std::vector<std::string>& columns,
                          const std::string& time = "sent") {
    file_.reset();
    return read_tables(path(), time, columns, "");
  }
  std::string complaint(const std::vector<std::string>& columns, const std::string& time = "sent") {
    try {
      read(columns, time);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  std::unique_ptr<lcm::LogFile> file_;
};

TEST_F(EventLog, RowsStandAtTheFirstChannelAndHoldTheLatestOfTheOthers) {
  touch(0.99, 1);  // no wrench yet
  pull(0.995, -1);
  touch(1, 10, 7);
  pull(1.005, 5);
  pull(1.009, 6);
  touch(1.01, 20, 8);
  touch(1.02, 30, 9);
  touch(5, 40);  // a gap
  touch(5.01, 50);
  const std::vector<Table> tables =
      read({"BIOTAC_0.electrodes[3]", "BIOTAC_0.pdc", "FT_WRENCH.wrench[0]"});
  ASSERT_EQ(tables.size(), 2u);
  ASSERT_EQ(tables[0].rows.rows(), 3);
  EXPECT_EQ(tables[0].rows.row(0), Eigen::RowVector3d(7, 10, -1));
  EXPECT_EQ(tables[0].rows.row(1), Eigen::RowVector3d(8, 20, 6));
  EXPECT_NEAR(tables[0].time[2], 0.02, 1e-9);
  EXPECT_EQ(tables[1].rows(1, 1), 50);
  EXPECT_EQ(tables[1].time[0], 0);
}

TEST_F(EventLog, NamesFileAndColumnOfWhatIsWrong) {
  touch(1, 1);
  touch(1.01, 2);
  pull(1, std::nan(""));
  EXPECT_THAT(complaint({"pdc"}), HasSubstr("a.log: column 'pdc': of a log is named CHANNEL"));
  EXPECT_THAT(complaint({"SHAPE.x"}), HasSubstr("channel SHAPE is none of"));
  EXPECT_THAT(complaint({"BIOTAC_5.pdc"}), HasSubstr("channel BIOTAC_5 is none of"));
  EXPECT_THAT(complaint({"BIOTAC_0.force"}), HasSubstr("no field 'force'"));
  EXPECT_THAT(complaint({"BIOTAC_0.electrodes"}), HasSubstr("an index is missing"));
  EXPECT_THAT(complaint({"BIOTAC_0.pdc[0]"}), HasSubstr("has no index"));
  EXPECT_THAT(complaint({"BIOTAC_0.electrodes[19]"}), HasSubstr("must be below 19"));
  EXPECT_THAT(complaint({"BIOTAC_1.pdc"}), HasSubstr("no message of channel BIOTAC_1"));
  EXPECT_THAT(complaint({"BIOTAC_0.pdc", "FT_WRENCH.wrench[0]"}),
              HasSubstr("column 'FT_WRENCH.wrench[0]': message 0 is not finite"));
  EXPECT_THAT(complaint({"BIOTAC_0.pdc"}, "t"), HasSubstr("'sent' or 'received', not 't'"));
  EXPECT_THROW(read_tables(path(), "sent", {"BIOTAC_0.pdc"}, "trial"), std::runtime_error);
  EXPECT_THROW(read_log_tables((folder_ / "b.log").string(), "sent", {"BIOTAC_0.pdc"}),
               std::runtime_error);
}

TEST_F(EventLog, IsDistinguishedFromCsvByItsContent) {
  touch(1, 10);
  touch(1.01, 20);
  file_.reset();
  const std::filesystem::path other_name = folder_ / "run.control.lcmlog";
  std::filesystem::rename(path(), other_name);
  EXPECT_TRUE(is_log(other_name.string()));
  EXPECT_EQ(read_tables(other_name.string(), "sent", {"BIOTAC_0.pdc"}, "").at(0).rows(1, 0), 20);

  std::ofstream(path()) << "t,pdc\n0,1\n0.01,2\n";  // a.log, and a CSV
  EXPECT_FALSE(is_log(path()));
  EXPECT_EQ(read_tables(path(), "t", {"pdc"}, "").at(0).rows(1, 0), 2);
  std::ofstream(path()) << "\xED\xA1\xDA";  // shorter than a sync word
  EXPECT_FALSE(is_log(path()));
  EXPECT_FALSE(is_log((folder_ / "none.log").string()));
}

TEST_F(EventLog, MessagesOfAnotherTypeAndTooFewRowsAreRefused) {
  write("BIOTAC_0", 1, ft_wrench_t{});
  EXPECT_THAT(complaint({"BIOTAC_0.pdc"}), HasSubstr("some are of another type"));
  file_ = std::make_unique<lcm::LogFile>(path(), "w");
  touch(1, 1);
  EXPECT_THAT(complaint({"BIOTAC_0.pdc"}), HasSubstr("fewer than two rows"));
}

TEST_F(EventLog, IsResampledToThePlansRateAndTaredByRecording) {
  for (int run = 0; run < 3; ++run)
    for (int k = 0; k < 200; ++k) {
      const double t = 10 * run + 0.005 * k;  // at 200 Hz
      pull(t - 0.001, 3);
      touch(t, 100 * run + (k >= 100 ? 5 : 0));
    }
  file_.reset();
  DataPlan plan;
  plan.time = "sent";
  plan.rate = 100;
  plan.tare = 0.3;
  plan.inputs = {{"pressure", {"BIOTAC_0.pdc"}, "count", 1}};
  plan.outputs = {{"force", {"FT_WRENCH.wrench[0]"}, "N", 1}};
  plan.recordings = {{"a.log", "", {}, {{0.9, 2}}, 3}};
  const DataSet data = load_data(plan, {"/nowhere", folder_.string()});
  ASSERT_EQ(data.recordings.size(), 3u);
  for (const Recording& recording : data.recordings) {
    EXPECT_EQ(recording.inputs.rows(), 100);
    EXPECT_EQ(recording.inputs(20, 0), 0);
    EXPECT_EQ(recording.inputs(80, 0), 5);
    EXPECT_NEAR(recording.outputs(80, 0), 0, 1e-12);
    EXPECT_EQ(recording.parts[95], Part::kTest);
  }
  EXPECT_EQ(data.recordings[1].parts[3], Part::kTraining);
  EXPECT_EQ(data.recordings[2].parts[3], Part::kValidation);
  EXPECT_THROW(load_data(plan, {"/nowhere"}), std::runtime_error);
}

}  // namespace
}  // namespace palpate::recordings
