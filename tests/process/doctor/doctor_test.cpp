// palpate-doctor as a process: network traffic, exit codes, JSON.

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <palpate/health_t.hpp>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate {
namespace {

using std::chrono::seconds;
using support::ChildProcess;

const std::string kDoctor = std::string(PALPATE_BIN_DIR) + "/palpate-doctor";
const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

class Doctor : public testing::Test {
 protected:
  void SetUp() override {
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{kDoctor,
                                   "--config",
                                   kExample,
                                   "--set",
                                   "bus.control=" + urls_[0].text(),
                                   "--set",
                                   "bus.housekeeping=" + urls_[1].text()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The finding of a check, from JSON on standard output.
  static nlohmann::json finding(const std::string& output, const std::string& check) {
    const nlohmann::json json = nlohmann::json::parse(output);
    for (const nlohmann::json& one : json["findings"]) {
      if (one["check"] == check) return one;
    }
    return nullptr;
  }

  bus::UdpmUrl urls_[2];
};

TEST_F(Doctor, HearsItselfAndNoDaemon) {
  ChildProcess doctor(command({"--json", "--seconds", "0.3"}));
  const int code = doctor.wait(seconds(60));
  const bool fails = nlohmann::json::parse(doctor.output())["verdict"] == "fail";
  EXPECT_EQ(code, fails ? 1 : 0) << doctor.output();
  EXPECT_EQ(finding(doctor.output(), "loopback")["verdict"], "ok");
  EXPECT_EQ(finding(doctor.output(), "configuration")["verdict"], "ok");
  const nlohmann::json daemons = finding(doctor.output(), "daemons");
  EXPECT_EQ(daemons["verdict"], "ok");
  EXPECT_EQ(daemons["found"], "0 heard on " + urls_[1].group());
}

TEST_F(Doctor, ListsTheChannelsOfAConfigurationBeforeItRuns) {
  ChildProcess doctor(command({"--channels", "--json"}));
  ASSERT_EQ(doctor.wait(seconds(60)), 0) << doctor.output();
  const nlohmann::json json = nlohmann::json::parse(doctor.output());
  const auto channel = [&json](const std::string& name) -> nlohmann::json {
    for (const nlohmann::json& one : json["channels"])
      if (one["channel"] == name) return one;
    return nullptr;
  };
  EXPECT_EQ(channel("FT_WRENCH")["type"], "ft_wrench_t");
  EXPECT_EQ(channel("FT_WRENCH")["direction"], "received");
  EXPECT_EQ(channel("FT_WRENCH")["url"], urls_[0].text());
  EXPECT_EQ(channel("TWIST_COMMAND")["direction"], "published");
  EXPECT_NEAR(channel("TWIST_COMMAND")["rate_hz"], 1000, 2);
  EXPECT_NEAR(channel("SHAPE")["rate_hz"], 100, 1);
  EXPECT_NEAR(channel("HEALTH")["rate_hz"], 10, 1);
  EXPECT_EQ(channel("SHAPE")["url"], urls_[1].text());
  EXPECT_EQ(channel("COMPONENT_EVENT")["rate_hz"], 0) << "on change";
  EXPECT_TRUE(channel("TWIST_COMMAND_1").is_null()) << "one arm";
  EXPECT_TRUE(channel("JOINT_VELOCITY_COMMAND").is_null()) << "by the flange";

  // Other loops, other rates.
  ChildProcess slow(command({"--channels", "--json", "--set", "loop.period_ms=2"}));
  ASSERT_EQ(slow.wait(seconds(60)), 0) << slow.output();
  const nlohmann::json slower = nlohmann::json::parse(slow.output());
  for (const nlohmann::json& one : slower["channels"]) {
    if (one["channel"] == "TWIST_COMMAND") {
      EXPECT_NEAR(one["rate_hz"], 500, 2);
    }
  }
  ChildProcess wrong(command({"--channels", "--set", "gate.no_such=1"}));
  EXPECT_EQ(wrong.wait(seconds(60)), 78) << wrong.output();
  EXPECT_NE(wrong.output().find("gate.no_such"), std::string::npos) << wrong.output();
}

TEST_F(Doctor, TwoDaemonsOnOneUrlFail) {
  std::atomic<bool> stop{false};
  std::thread daemons([&] {
    const auto bus = bus::make_lcm_bus(urls_[1].text());
    bus::TypedPublisher<health_t> publisher(*bus, "HEALTH");
    for (int i = 0; !stop; ++i) {
      health_t health{};
      health.session = 1 + i % 2;
      publisher.publish(health);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  ChildProcess doctor(command({"--json", "-", "--seconds", "3"}));
  EXPECT_EQ(doctor.wait(seconds(60)), 1) << doctor.output();
  stop = true;
  daemons.join();
  EXPECT_EQ(finding(doctor.output(), "daemons")["verdict"], "fail");
}

TEST_F(Doctor, AConfigurationThatIsWrongFails) {
  ChildProcess doctor(command({"--no-live", "--plain", "--set", "loop.no_such_key=1"}));
  EXPECT_EQ(doctor.wait(seconds(60)), 1) << doctor.output();
  EXPECT_NE(doctor.output().find("fail  configuration"), std::string::npos) << doctor.output();
  EXPECT_NE(doctor.output().find("no_such_key"), std::string::npos);
  EXPECT_EQ(doctor.output().find("loopback"), std::string::npos);
}

TEST_F(Doctor, NeverOverwritesAConfigurationWithItsReport) {
  ChildProcess doctor({kDoctor, "--json", kExample});
  EXPECT_EQ(doctor.wait(seconds(20)), 64);  // a wrong command line
  EXPECT_NE(doctor.output().find("--json"), std::string::npos) << doctor.output();
}

TEST_F(Doctor, WarningsFailInStrictMode) {
  const support::ScratchFolder empty;
  ChildProcess lenient({kDoctor, "--root", empty.path().string()});
  EXPECT_EQ(lenient.wait(seconds(20)), 1) << "no route at all";
  ChildProcess strict(command({"--strict", "--no-live", "--only-bad", "--set", "loop.cpu=0"}));
  EXPECT_EQ(strict.wait(seconds(60)), 1) << strict.output();  // cpu 0 is never isolated
  EXPECT_NE(strict.output().find("isolcpus"), std::string::npos) << strict.output();
}

}  // namespace
}  // namespace palpate
