#include "tools/export/csv_export.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <palpate/component_event_t.hpp>
#include <palpate/picture_t.hpp>

#include "tests/unit/tools/export/small_run.hpp"

namespace palpate::exporting {
namespace {

std::vector<std::string> lines(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> result;
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

TEST(CsvExport, EachChannelIsATableWithItsColumnsExplained) {
  const SmallRun run;
  Source source(quiet({run.control(), run.housekeeping()}));
  const std::filesystem::path folder = run.folder() / "csv";
  const std::vector<Written> written = export_csv(source, folder);
  EXPECT_EQ(written.size(), 8u);
  const auto wrench = lines(folder / "FT_WRENCH.csv");
  ASSERT_EQ(wrench.size(), 101u);
  EXPECT_EQ(wrench[0],
            "time,received_utime,utime,seq,session,wrench[0],wrench[1],wrench[2],wrench[3],"
            "wrench[4],wrench[5]");
  // The first TRUTH_SHAPE came 10 ms before.
  EXPECT_EQ(wrench[2],
            "0.020000,1700000000010000,1700000000009000,1,0000000000000005,0.5,1.5,2.5,3.5,4.5,"
            "5.5");
  const auto meaning = lines(folder / "FT_WRENCH.columns.csv");
  ASSERT_EQ(meaning.size(), 12u);  // a header, and one line per column
  EXPECT_EQ(meaning[0], "column,unit,meaning");
  EXPECT_EQ(meaning[1].substr(0, 7), "time,s,");
  EXPECT_EQ(meaning[6], "wrench[0],N,\"N, N m; force first\"");
  EXPECT_EQ(meaning[11], "wrench[5],N m,\"N, N m; force first\"");
  // Of eight possible contacts one is in use, of 16 joints seven.
  EXPECT_NE(lines(folder / "CONTACTS.csv")[0].find("wrench[0][5]"), std::string::npos);
  EXPECT_EQ(lines(folder / "CONTACTS.csv")[0].find("wrench[1]"), std::string::npos);
  EXPECT_NE(lines(folder / "ROBOT_STATE.csv")[0].find("q[6],dq[0]"), std::string::npos);
}

TEST(CsvExport, ChannelsTimesAndClockAreChosen) {
  const SmallRun run;
  SourceOptions options = quiet({run.control(), run.housekeeping()});
  options.channels = {"FT_*"};
  options.clock = Clock::kSent;
  options.from = 0.095;
  options.to = 0.205;
  Source source(options);
  const std::filesystem::path folder = run.folder() / "csv";
  const std::vector<Written> written = export_csv(source, folder);
  ASSERT_EQ(written.size(), 1u);
  EXPECT_EQ(written[0].count, 11);
  const auto wrench = lines(folder / "FT_WRENCH.csv");
  EXPECT_EQ(wrench[1].substr(0, 8), "0.100000");
  // All were sent 1 ms before they were received.
  EXPECT_EQ(source.origin(), SmallRun::kStart - 11'000);
  options.clock = Clock::kReceived;
  EXPECT_EQ(Source(options).origin(), SmallRun::kStart - 10'000);
  EXPECT_EQ(wrench.size(), 12u);

  options.channels = {"NONE_*"};
  try {
    Source(options).found();
    FAIL() << "a channel that is not there";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("FT_WRENCH"), std::string::npos) << error.what();
  }
}

// In lock-step a user's command uses the wall clock, everything else the simulator's.
TEST(CsvExport, ByTheSendersClockAStrangerIsWhereItStandsInTheLog) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "log";
  {
    LogWriter log(file);
    const std::int64_t wall = 1'700'000'000'000'000;
    ft_wrench_t wrench{};
    wrench.session = 1;
    component_event_t event{};
    event.session = 2;
    event.utime = wall;
    log.write("BEFORE", wall, event);
    for (int i = 0; i < 5; ++i) {
      wrench.utime = 1'000'000 + 1000 * i;
      log.write("FT_WRENCH", wall + 70'000 * i, wrench);
      if (i == 2) log.write("COMPONENT_EVENT", wall + 70'000 * i, event);
    }
  }
  SourceOptions options = quiet({file});
  options.clock = Clock::kSent;
  Source source(options);
  EXPECT_EQ(source.found().strange_clocks, std::set<std::int64_t>{2});
  EXPECT_EQ(source.origin(), 1'000'000);
  export_csv(source, scratch.path());
  EXPECT_EQ(lines(scratch.path() / "FT_WRENCH.csv")[5].substr(0, 9), "0.004000,");
  EXPECT_EQ(lines(scratch.path() / "COMPONENT_EVENT.csv")[1].substr(0, 9), "0.002000,");
  EXPECT_EQ(lines(scratch.path() / "BEFORE.csv")[1].substr(0, 9), "0.000000,");

  options.channels = {"COMPONENT_EVENT"};  // although the others are not selected
  Source alone(options);
  export_csv(alone, scratch.path() / "alone");
  EXPECT_EQ(lines(scratch.path() / "alone/COMPONENT_EVENT.csv")[1].substr(0, 9), "0.002000,");
}

TEST(CsvExport, TextsBytesAndUnlikeLengths) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "log";
  {
    LogWriter log(file);
    component_event_t event{};
    std::copy_n("a, \"b\"", 6, event.reason);
    event.session = -1;
    log.write("COMPONENT_EVENT", 1000, event);
    shape_t shape{};
    shape.xyz = {0.5F, 1, 2};
    shape.xyz_count = 3;
    log.write("SHAPE", 2000, shape);
    shape.xyz = {0.25F};
    shape.xyz_count = 1;
    log.write("SHAPE", 3000, shape);
    picture_t picture{};
    picture.data = {1, 2, 3, 4};
    picture.size = 4;
    log.write("PICTURE", 4000, picture);
    log.write_bytes("FOREIGN", 5000, {1, 2, 3});
    log.write_bytes("SHAPE", 6000, {0xb9, 0xcb, 0x4e, 0xa6, 0x1f, 0xf4, 0x18, 0x33, 0, 0});
  }
  Source source(quiet({file}));
  EXPECT_EQ(source.found().unknown(), 1);
  EXPECT_EQ(source.found().broken(), 1);
  const std::vector<Written> written = export_csv(source, scratch.path());
  ASSERT_EQ(written.size(), 3u);
  const auto event = lines(scratch.path() / "COMPONENT_EVENT.csv");
  EXPECT_EQ(event[1], "0.000000,1000,0,0,ffffffffffffffff,,,,,0,\"a, \"\"b\"\"\"");
  const auto shape = lines(scratch.path() / "SHAPE.csv");
  ASSERT_EQ(shape.size(), 3u);
  EXPECT_NE(shape[0].find("xyz[0],xyz[1],xyz[2]"), std::string::npos);
  EXPECT_NE(shape[2].find(",0.25,,"), std::string::npos) << shape[2];
  const auto picture = lines(scratch.path() / "PICTURE.csv");
  EXPECT_NE(picture[0].find("data.length"), std::string::npos);
  EXPECT_EQ(picture[1].substr(picture[1].size() - 2), ",4");
}

TEST(CsvExport, WhatCannotBeWrittenIsReported) {
  const SmallRun run;
  Source source(quiet({run.control()}));
  std::ofstream(run.folder() / "file") << "in the way";
  EXPECT_THROW(export_csv(source, run.folder() / "file"), std::runtime_error);
}

}  // namespace
}  // namespace palpate::exporting
