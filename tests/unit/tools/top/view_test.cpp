#include "tools/top/view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::top {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // ns

health_t active() {
  health_t health{};
  health.session = 5;
  health.state = 2;
  health.cycles = 1234;
  health.overruns = 3;
  health.gate_rejected = 4;
  health.phase_count = 10;
  for (int i = 0; i < 10; ++i) health.p99_us[i] = 10.5f * static_cast<float>(i + 1);
  health.input_count = 2;
  std::memcpy(health.input_name[0], "FT_WRENCH", 10);
  health.received[0] = 900;
  health.lost[0] = 2;
  health.age_ms[0] = 1.5f;
  std::memcpy(health.input_name[1], "IMU", 4);
  return health;
}

class ViewTest : public testing::Test {
 protected:
  template <class Message>
  void hear(const std::string& channel, const Message& message, std::int64_t ns) {
    const auto data = bus::wire::encoded(message);
    watch_.take({1, ns / 1000, ns, channel, data.data(), static_cast<int>(data.size())});
  }
  View view(std::int64_t now_ns) const {
    return {nullptr, record::default_sources(), rows_, &watch_, now_ns};
  }
  /// Lines that contain the words.
  std::vector<Line> with(const std::string& words, std::int64_t now_ns) const {
    std::vector<Line> found;
    for (const Line& line : lines_of(view(now_ns))) {
      if (line.text.find(words) != std::string::npos) found.push_back(line);
    }
    return found;
  }

  DaemonWatch watch_;
  std::vector<ChannelRow> rows_;
};

TEST_F(ViewTest, SaysWhenNothingIsHeard) {
  EXPECT_EQ(with("palpated: nothing heard", 0).size(), 1u);
  EXPECT_EQ(with("nothing heard on any channel", 0).size(), 1u);
  EXPECT_TRUE(json_of(view(0))["daemon"].is_null());
}

TEST_F(ViewTest, ShowsTheDaemon) {
  hear("HEALTH", active(), kSecond);
  ASSERT_EQ(with("palpated: active", kSecond).size(), 1u);
  EXPECT_EQ(with("palpated: active", kSecond)[0].tone, Tone::kGood);
  EXPECT_EQ(with("cycles 1234, overruns 3", kSecond).size(), 1u);
  ASSERT_EQ(with("p99 ", kSecond).size(), 1u);
  EXPECT_NE(with("p99 ", kSecond)[0].text.find("105.0"), std::string::npos) << "of the last phase";
  ASSERT_EQ(with("FT_WRENCH", kSecond).size(), 1u);
  EXPECT_EQ(with("FT_WRENCH", kSecond)[0].tone, Tone::kWarning) << "it has lost two";
  EXPECT_TRUE(with("IMU", kSecond).empty()) << "nothing ever came";
  EXPECT_TRUE(with("silent", kSecond).empty());
  EXPECT_EQ(with("silent for 4000 ms", 5 * kSecond).size(), 1u);
  const nlohmann::json json = json_of(view(kSecond));
  EXPECT_EQ(json["daemon"]["state"], "active");
  EXPECT_EQ(json["daemon"]["latency_us"]["wake-up"]["p99"], 105);
  EXPECT_EQ(json["daemon"]["inputs"]["FT_WRENCH"]["lost"], 2);
  EXPECT_EQ(json["daemon"]["gate_rejected"], 4) << "as HEALTH names it";
}

TEST_F(ViewTest, FaultsStandOutWithTheirReason) {
  health_t health = active();
  health.state = 4;
  std::memcpy(health.reason, "20 ms without a command", 24);
  hear("HEALTH", health, kSecond);
  const auto lines = with("palpated: faulted: 20 ms without a command", kSecond);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].tone, Tone::kBad);
}

TEST_F(ViewTest, TwoDaemonsAreReported) {
  hear("HEALTH", active(), kSecond);
  EXPECT_TRUE(with("daemons", kSecond).empty());
  health_t other = active();
  other.session = 6;
  hear("HEALTH", other, kSecond);
  EXPECT_EQ(with("2 daemons", kSecond).size(), 1u);
  other.session = 6;
  hear("HEALTH", other, 5 * kSecond);
  EXPECT_TRUE(with("daemons", 5 * kSecond).empty()) << "the first has ended";
}

TEST_F(ViewTest, EventsAreShownInALine) {
  component_event_t event{};
  std::memcpy(event.slot, "sensing", 8);
  std::memcpy(event.event, "degraded", 9);
  std::memcpy(event.reason, "wrench is old", 14);
  hear("COMPONENT_EVENT", event, kSecond);
  hear("HEALTH", active(), kSecond);
  EXPECT_EQ(with("last event: sensing degraded: wrench is old", kSecond).size(), 1u);
}

TEST_F(ViewTest, ShowsTheTestOfTheWrenches) {
  hear("HEALTH", active(), kSecond);
  EXPECT_TRUE(with("wrenches", kSecond).empty()) << "it is not tested";
  discrepancy_t test{};
  test.test = -1;
  hear("DISCREPANCY", test, kSecond);
  EXPECT_TRUE(with("wrenches", kSecond).empty()) << "no test yet";
  test.test = 1.25;
  test.threshold = 4.9;
  hear("DISCREPANCY", test, kSecond);
  const auto agree = with("wrenches agree with the model: test 1.25, threshold 4.90", kSecond);
  ASSERT_EQ(agree.size(), 1u);
  EXPECT_EQ(agree[0].tone, Tone::kPlain);
  EXPECT_TRUE(with("wrenches", 4 * kSecond).empty()) << "it is no longer tested";
}

TEST_F(ViewTest, ShowsWhatExplainsAContradiction) {
  hear("HEALTH", active(), kSecond);
  discrepancy_t test{};
  test.inconsistent = 1;
  test.duration = 2.1;
  test.test = 8;
  test.threshold = 4.9;
  test.axis = 2;
  hear("DISCREPANCY", test, kSecond);
  const std::string begin =
      "wrenches contradict the model for 2.1 s: test 8.00, threshold 4.90, force of hand 0 along z";
  ASSERT_EQ(with(begin, kSecond).size(), 1u);
  EXPECT_EQ(with(begin, kSecond)[0].text, begin) << "nothing is explained yet";
  test.cause_count = 2;
  test.cause[0] = discrepancy_t::CAUSE_SENSOR_BIAS;
  test.value[0][0] = 0.5;
  test.probability[0] = 0.82;
  test.cause[1] = discrepancy_t::CAUSE_SLIP;
  test.probability[1] = 0.1;
  hear("DISCREPANCY", test, kSecond);
  const auto lines = with(begin, kSecond);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].tone, Tone::kBad);
  EXPECT_EQ(lines[0].text, begin + "; most likely sensor bias of hand 0, 0.50 N, 0.0 mN m (0.82)");
  const nlohmann::json json = json_of(view(kSecond))["daemon"]["discrepancy"];
  EXPECT_EQ(json["inconsistent"], true);
  EXPECT_EQ(json["threshold"], 4.9);
  ASSERT_EQ(json["explanations"].size(), 2u);
  EXPECT_EQ(json["explanations"][1]["probability"], 0.1);
}

TEST_F(ViewTest, WhateverHealthSaysIsPrintedSafely) {
  health_t mad{};
  mad.state = -7;
  mad.phase_count = std::numeric_limits<int>::max();
  mad.input_count = std::numeric_limits<int>::max();
  std::memset(mad.reason, 0x1b, sizeof(mad.reason));
  std::memset(mad.input_name, 0xff, sizeof(mad.input_name));
  for (int i = 0; i < 16; ++i) {
    mad.received[i] = std::numeric_limits<std::int64_t>::min();
    mad.age_ms[i] = std::numeric_limits<float>::quiet_NaN();
  }
  for (int i = 0; i < 10; ++i) mad.max_us[i] = std::numeric_limits<float>::infinity();
  hear("HEALTH", mad, kSecond);
  for (const Line& line : lines_of(view(kSecond))) {
    for (const char c : line.text) EXPECT_TRUE(c >= 32 && c < 127) << line.text;
  }
  EXPECT_EQ(with("palpated: unknown", kSecond).size(), 1u);
}

TEST_F(ViewTest, AFrameIsNeverLargerThanTheScreen) {
  std::vector<Line> lines;
  for (int i = 0; i < 100; ++i)
    lines.push_back({std::string(300, static_cast<char>('a' + i % 26)), Tone::kBad});
  for (const bool colours : {true, false}) {
    for (const int columns : {1, 20, 80}) {
      const std::string text = frame(lines, columns, 10, 5, colours, "q quit");
      EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 9);
      int width = 0, escape = 0;
      for (const char c : text) {
        if (c == '\x1b') escape = 1;
        if (escape != 0) {
          if (std::isalpha(static_cast<unsigned char>(c)) != 0) escape = 0;
          continue;
        }
        width = c == '\r' || c == '\n' ? 0 : width + 1;
        EXPECT_LE(width, columns + 6) << "the keys follow in the last row";
      }
      EXPECT_EQ(text.find("\x1b[1;31m") != std::string::npos, colours);
      EXPECT_EQ(text.find("! f") != std::string::npos, !colours && columns > 2);
    }
  }
}

}  // namespace
}  // namespace palpate::top
