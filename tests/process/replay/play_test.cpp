// palpate-replay as a process: plays logs over LCM, and reproduces a lock-step run bit by bit.

#include <gtest/gtest.h>
#include <pty.h>

#include <lcm/lcm-cpp.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <palpate/ft_wrench_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using support::ChildProcess;

const std::string kBin = PALPATE_BIN_DIR;
const std::string kSource = PALPATE_SOURCE_DIR;

template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

class Play : public testing::Test {
 protected:
  void SetUp() override {
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// A message every 10 ms on each of the channels.
  std::string log(const std::string& name, int count,
                  const std::vector<std::string>& channels) const {
    lcm::LogFile file(path(name), "w");
    for (int i = 0; i < count; ++i) {
      for (const std::string& channel : channels) {
        ft_wrench_t message{};
        message.seq = i;
        auto data = bus::wire::encoded(message);
        lcm::LogEvent event{};
        event.timestamp = 1'000'000 + 10'000 * i;
        event.channel = channel;
        event.datalen = static_cast<int>(data.size());
        event.data = data.data();
        file.writeEvent(&event);
      }
    }
    return path(name);
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        kBin + "/palpate-replay",     "play",  "--url",
        "control=" + urls_[0].text(), "--url", "housekeeping=" + urls_[1].text()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  bus::UdpmUrl urls_[2];
  support::ScratchFolder folder_;
};

TEST_F(Play, SendsEachLogToItsUrlButNotWhatMovesARobot) {
  const auto control = bus::make_lcm_bus(urls_[0].text());
  const auto housekeeping = bus::make_lcm_bus(urls_[1].text());
  bus::TypedSubscription<ft_wrench_t> wrench(*control, "FT_WRENCH", 200),
      twist(*control, "TWIST_COMMAND", 200), shape(*housekeeping, "SHAPE", 200);
  control->start();
  housekeeping->start();
  const std::string first = log("run.control.lcmlog", 50, {"FT_WRENCH", "TWIST_COMMAND"});
  const std::string second = log("run.housekeeping.lcmlog", 50, {"SHAPE"});
  ChildProcess play(command({first, second, "--rate", "5"}));
  EXPECT_EQ(play.wait(seconds(60)), 0) << play.output();
  EXPECT_TRUE(eventually([&] { return wrench.counters().received == 50; }));
  EXPECT_TRUE(eventually([&] { return shape.counters().received == 50; }));
  EXPECT_EQ(twist.counters().received, 0);
  EXPECT_NE(play.output().find("100 messages sent, 50 left out"), std::string::npos)
      << play.output();

  ChildProcess part(command(
      {first, "--commands", "-c", "TWIST.*", "--start", "0.1", "--end", "0.3", "--rate", "5"}));
  EXPECT_EQ(part.wait(seconds(60)), 0) << part.output();
  EXPECT_TRUE(eventually([&] { return twist.counters().received == 21; }))
      << twist.counters().received;
  EXPECT_EQ(wrench.counters().received, 50);
}

TEST_F(Play, TakesAsLongAsTheRateSays) {
  const std::string file = log("run.control.lcmlog", 51, {"FT_WRENCH"});
  const auto began = std::chrono::steady_clock::now();
  ChildProcess play(command({file, "--rate", "0.5"}));
  EXPECT_EQ(play.wait(seconds(60)), 0) << play.output();
  EXPECT_GE(std::chrono::steady_clock::now() - began, milliseconds(1000));
}

TEST_F(Play, KeysPauseAndQuit) {
  const auto control = bus::make_lcm_bus(urls_[0].text());
  bus::TypedSubscription<ft_wrench_t> wrench(*control, "FT_WRENCH", 200);
  control->start();
  std::vector<std::string> words =
      command({log("run.control.lcmlog", 50, {"FT_WRENCH"}), "--loop"});
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  const auto received = [&] { return wrench.counters().received.load(); };
  ASSERT_TRUE(eventually([&] { return received() > 60; })) << "it begins again at the end";
  ASSERT_EQ(write(terminal, " ", 1), 1);
  // It has paused if a whole second passes without a message.
  EXPECT_TRUE(eventually([&] {
    const std::int64_t before = received();
    std::this_thread::sleep_for(seconds(1));
    return received() == before;
  }));
  const std::int64_t paused = received();
  ASSERT_EQ(write(terminal, ".", 1), 1);
  EXPECT_TRUE(eventually([&] { return received() == paused + 1; })) << "one message";
  ASSERT_EQ(write(terminal, " ", 1), 1);
  EXPECT_TRUE(eventually([&] { return received() > paused + 20; }));
  ASSERT_EQ(write(terminal, "q", 1), 1);
  char bytes[4096];
  while (read(terminal, bytes, sizeof(bytes)) > 0) {
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  close(terminal);
}

TEST_F(Play, RefusesWhatItShouldAndSaysWhy) {
  const std::string file = log("run.control.lcmlog", 5, {"FT_WRENCH"});
  const auto refused = [&](const std::vector<std::string>& more, const std::string& words) {
    ChildProcess play(command(more));
    EXPECT_NE(play.wait(seconds(20)), 0);
    EXPECT_NE(play.output().find(words), std::string::npos) << play.output();
  };
  refused({file, "--start", "7"}, "--start");
  refused({"other=" + file}, "other");
  refused({path("nowhere.lcmlog")}, "nowhere.lcmlog");
  refused({}, "logs");
}

#ifdef PALPATE_HAS_SIM
TEST_F(Play, ARunInLockStepIsRepeatedBitByBit) {
  const std::string control = urls_[0].text(), housekeeping = urls_[1].text();
  const std::string configuration = kSource + "/rt/config/examples/bar_long_soft.yaml";
  const std::vector<std::string> urls{"--set", "bus.control=" + control, "--set",
                                      "bus.housekeeping=" + housekeeping};
  const auto with_urls = [&](std::vector<std::string> words) {
    words.insert(words.end(), urls.begin(), urls.end());
    return words;
  };
  ChildProcess recorder({kBin + "/palpate-record", "--url", "control=" + control, "--url",
                         "housekeeping=" + housekeeping, "--only", "control,housekeeping",
                         "--min-free-mb", "0", path("run")});
  ASSERT_TRUE(eventually([&] {
    return recorder.output().find("housekeeping udpm") != std::string::npos;
  })) << recorder.output();
  ChildProcess daemon(with_urls({kBin + "/palpated", "--config", configuration, "--stepped"}));
  ASSERT_TRUE(eventually([&] {
    return daemon.output().find("waits for start") != std::string::npos;
  })) << daemon.output();
  ChildProcess sim(
      with_urls({kBin + "/palpate-sim", kSource + "/sim/scenes/bar_long_soft_control.yaml",
                 "--fast", "--duration", "1", "--set", "object.elements=[10, 1, 1]"}));
  ChildProcess start({kBin + "/palpate-command", "--url", control, "--url",
                      "housekeeping=" + housekeeping, "start"});
  EXPECT_EQ(start.wait(seconds(60)), 0) << start.output();
  EXPECT_EQ(sim.wait(seconds(100)), 0) << sim.output();
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(seconds(20)), 0) << daemon.output();
  recorder.send(SIGTERM);
  EXPECT_EQ(recorder.wait(seconds(20)), 0) << recorder.output();
  const auto count = [&](const std::string& words) {
    int found = 0;
    for (std::size_t at = 0; (at = recorder.output().find(words, at)) != std::string::npos; ++at)
      ++found;
    return found;
  };
  if (count("lost on the way 0,") != 1 || count("lost in the socket's buffer 0\n") != 2)
    GTEST_SKIP() << "this machine lost messages: " << recorder.output();

  ChildProcess again({kBin + "/palpate-replay", path("run.control.lcmlog"), "--config",
                      configuration, "--stepped", "--compare", "--housekeeping",
                      path("run.housekeeping.lcmlog"), "--json", path("summary.json")});
  EXPECT_EQ(again.wait(seconds(100)), 0) << again.output();
  EXPECT_NE(again.output().find("bit-identical"), std::string::npos) << again.output();
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(path("summary.json")));
  EXPECT_EQ(json["comparison"]["TWIST_COMMAND"]["equal"], 1000)
      << again.output() << recorder.output() << sim.output();
  const nlohmann::json& shapes = json["comparison"]["SHAPE"];  // 100 from the start on
  EXPECT_EQ(shapes["equal"], shapes["recorded"]);
  EXPECT_GT(shapes["recorded"], 0);

  // With another configuration the run differs.
  ChildProcess other({kBin + "/palpate-replay", path("run.control.lcmlog"), "--config",
                      configuration, "--stepped", "--compare", "--housekeeping",
                      path("run.housekeeping.lcmlog"), "--set",
                      "object.material.young_modulus=20e3"});
  EXPECT_EQ(other.wait(seconds(100)), 4) << other.output();
}
#endif

}  // namespace
}  // namespace palpate
