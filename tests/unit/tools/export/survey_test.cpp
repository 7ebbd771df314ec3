#include <gtest/gtest.h>

#include <palpate/imu_t.hpp>
#include <sstream>

#include "tests/unit/tools/export/small_run.hpp"
#include "tools/export/survey.hpp"

namespace palpate::exporting {
namespace {

TEST(Survey, CountsRatesLossesSessionsAndStrangers) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "log";
  {
    LogWriter log(file);
    imu_t imu{};
    for (int i = 0; i <= 100; ++i) {
      if (i >= 40 && i < 45) continue;
      imu.seq = i;
      imu.session = i < 60 ? 1 : 2;
      imu.utime = 77 + 10'000 * i;
      log.write("IMU", 5'000'000 + 10'000 * i, imu);
    }
    log.write("ELSEWHERE", 5'000'000, ft_wrench_t{});
    log.write_bytes("CAMERA", 5'000'001, std::vector<std::uint8_t>(20, 0xab));
    log.write_bytes("CAMERA", 5'000'002, {1, 2});
  }
  log::MergedLog merged({file});
  double last = -1;
  const Survey found = survey(merged, [&last](double part) { last = part; });
  EXPECT_GE(last, 0);
  EXPECT_EQ(found.events, 99);
  EXPECT_EQ(found.unknown(), 2);
  ASSERT_EQ(found.channels.size(), 4u);  // two kinds of bytes on CAMERA
  const ChannelSurvey* imu = nullptr;
  for (const ChannelSurvey& channel : found.channels)
    if (channel.channel == "IMU") imu = &channel;
  ASSERT_NE(imu, nullptr);
  EXPECT_EQ(imu->type->name, "imu_t");
  EXPECT_EQ(imu->messages, 96);
  EXPECT_EQ(imu->lost(), 5);
  EXPECT_EQ(imu->sessions.size(), 2u);
  EXPECT_NEAR(imu->rate(), 95, 1e-9);  // 95 intervals in a second
  EXPECT_EQ(imu->longest_gap, 60'000);
  EXPECT_EQ(imu->sent.first, 77);

  std::ostringstream table;
  print_info(found, table);
  EXPECT_NE(table.str().find("? abababababababab"), std::string::npos) << table.str();
  EXPECT_NE(table.str().find("session 0000000000000001: 55 messages, 5 lost"), std::string::npos)
      << table.str();
  const nlohmann::json json = info_json(found);
  EXPECT_EQ(json["unknown"], 2);
  EXPECT_EQ(json["channels"].size(), 4u);
  std::ostringstream fields;
  print_fields(found, fields);
  EXPECT_NE(fields.str().find("acceleration[3]"), std::string::npos);
  EXPECT_NE(fields.str().find("m/s^2"), std::string::npos);
}

}  // namespace
}  // namespace palpate::exporting
