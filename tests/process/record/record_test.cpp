// palpate-record as a process: stock programs play its logs, and input that terminates lcm-logger
// does not terminate it.

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/health_t.hpp>

#include "rt/bus/event_log_reader.hpp"
#include "rt/bus/message_bus.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/bus/messages.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using bus::wire::Injector;
using std::chrono::seconds;
using support::ChildProcess;

const std::string kRecorder = std::string(PALPATE_BIN_DIR) + "/palpate-record";

template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

class Record : public testing::Test {
 protected:
  void SetUp() override {
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::vector<std::string> command(std::vector<std::string> more) const {
    const char* labels[] = {"control", "housekeeping", "pictures"};
    std::vector<std::string> words{kRecorder, "--min-free-mb", "0"};
    for (int i = 0; i < 3; ++i) {
      words.push_back("--url");
      words.push_back(std::string(labels[i]) + "=" + urls_[i].text());
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static bool listens(const ChildProcess& recorder) {
    return eventually([&] { return recorder.output().find("pictures udpm") != std::string::npos; });
  }
  /// By channel. In a log that is still written, the last event may be truncated.
  static std::map<std::string, int> content_of(const std::string& file, bool is_whole = true) {
    std::map<std::string, int> content;
    bus::EventLogReader log(file);
    while (const bus::LoggedEvent* event = log.next()) ++content[event->channel];
    EXPECT_EQ(is_whole ? log.complaint() : "", "");
    return content;
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(std::ifstream(path("summary.json")));
  }
  static void publish(bus::MessageBus& bus, const std::string& channel, int first, int last) {
    bus::TypedPublisher<ft_wrench_t> publisher(bus, channel);
    ft_wrench_t message{};
    message.session = 3;
    for (int i = first; i < last; ++i) {
      message.seq = i;
      ASSERT_TRUE(publisher.publish(message));
      if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  support::ScratchFolder folder_;
  bus::UdpmUrl urls_[3];
};

TEST_F(Record, ThreeUrlsAtOnceAmongPacketsThatEndOthers) {
  ChildProcess recorder(command({"--json", path("summary.json"), path("run")}));
  ASSERT_TRUE(listens(recorder)) << recorder.output();
  const auto control = bus::make_lcm_bus(urls_[0].text());
  const auto housekeeping = bus::make_lcm_bus(urls_[1].text());
  const auto pictures = bus::make_lcm_bus(urls_[2].text());
  Injector injector(urls_[0]);
  inject::PacketSource source(1, inject::malformed_kinds(), inject::usual_targets());
  constexpr int kBad = 3000;
  for (int i = 0; i < kBad; ++i) {
    const std::vector<std::uint8_t>& packet = source.next();
    ASSERT_TRUE(injector.send(packet.data(), packet.size()));
    if (i % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  publish(*control, "GOOD", 0, 400);
  publish(*control, "GOOD", 410, 500);  // ten that were never sent
  publish(*housekeeping, "SHAPE", 0, 200);
  publish(*pictures, "PICTURE", 0, 100);
  publish(*pictures, "END", 0, 1);
  ASSERT_TRUE(recorder.running()) << recorder.output();
  ASSERT_TRUE(eventually([&] { return fs::file_size(path("run.pictures.lcmlog")) > 0; }));
  recorder.send(SIGINT);
  EXPECT_EQ(recorder.wait(seconds(20)), 0) << recorder.output();

  const nlohmann::json json = summary();
  const nlohmann::json& counters = json["urls"]["control"];
  const int overflowed = counters["overflowed"];  // on a machine with small buffers, when busy
  EXPECT_EQ(counters["datagrams"].get<int>() + overflowed, kBad + 490);
  const int lost = json["lost"];
  EXPECT_TRUE(overflowed == 0 ? lost == 10 : lost >= 10) << json.dump(2);
  EXPECT_EQ(json["unwritten"], 0);
  EXPECT_EQ(content_of(path("run.control.lcmlog"))["GOOD"], 500 - lost);
  EXPECT_EQ(content_of(path("run.housekeeping.lcmlog")),
            (std::map<std::string, int>{{"SHAPE", 200}}));
  EXPECT_EQ(content_of(path("run.pictures.lcmlog")),
            (std::map<std::string, int>{{"END", 1}, {"PICTURE", 100}}));
  EXPECT_GT(counters["malformed"], 100);
  EXPECT_GT(counters["fragmented"], 100);
  EXPECT_GT(json["misfits"], 100);
}

TEST_F(Record, MessagesOfSeveralFragmentsAreRecordedUpToTheBound) {
  ChildProcess recorder(
      command({"--largest-mb", "0.3", "--json", path("summary.json"), path("run")}));
  ASSERT_TRUE(listens(recorder)) << recorder.output();
  lcm::LCM sender(urls_[0].text());  // sends fragments as other programs do
  ASSERT_TRUE(sender.good());
  std::vector<std::uint8_t> bytes(300'001);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i >> 7);
  sender.publish("TOO_LARGE", bytes.data(), 300'001);
  sender.publish("POINT_CLOUD", bytes.data(), 300'000);
  sender.publish("SHORT", bytes.data(), 100);
  ASSERT_TRUE(eventually([&] { return fs::file_size(path("run.control.lcmlog")) > 300'100; }));
  recorder.send(SIGINT);
  EXPECT_EQ(recorder.wait(seconds(20)), 0) << recorder.output();
  std::map<std::string, std::vector<std::uint8_t>> content;
  bus::EventLogReader log(path("run.control.lcmlog"));
  while (const bus::LoggedEvent* event = log.next())
    content[event->channel].assign(event->data, event->data + event->size);
  ASSERT_EQ(content.size(), 2U);
  EXPECT_EQ(content["SHORT"].size(), 100U);
  bytes.pop_back();
  EXPECT_EQ(content["POINT_CLOUD"], bytes);
  EXPECT_EQ(summary()["urls"]["control"]["fragmented"], 5) << "of TOO_LARGE, 65 kB each";
}

TEST_F(Record, LcmLogplayerPlaysItUnchanged) {
  ChildProcess recorder(command({path("run")}));
  ASSERT_TRUE(listens(recorder)) << recorder.output();
  publish(*bus::make_lcm_bus(urls_[0].text()), "FT_WRENCH", 0, 300);
  ASSERT_TRUE(eventually(
      [&] { return content_of(path("run.control.lcmlog"), false)["FT_WRENCH"] == 300; }));
  recorder.send(SIGTERM);
  ASSERT_EQ(recorder.wait(seconds(20)), 0) << recorder.output();

  const bus::UdpmUrl elsewhere = bus::private_url();
  const auto bus = bus::make_lcm_bus(elsewhere.text());
  bus::TypedSubscription<ft_wrench_t> heard(*bus, "FT_WRENCH", 400);
  bus->start();
  ChildProcess player(
      {"/usr/bin/lcm-logplayer", "--lcm-url=" + elsewhere.text(), path("run.control.lcmlog")});
  const int code = player.wait(seconds(30));
  if (!fs::exists("/usr/bin/lcm-logplayer")) GTEST_SKIP() << "lcm-logplayer is absent";
  EXPECT_EQ(code, 0) << player.output();
  EXPECT_TRUE(eventually([&] { return heard.counters().received == 300; }))
      << heard.counters().received;
}

TEST_F(Record, RotatesBySizeAndOnDemandAndLosesNothing) {
  ChildProcess recorder(
      command({"--only", "control", "--rotate", "50", "--split-mb", "0.01", path("run.lcmlog")}));
  ASSERT_TRUE(eventually([&] { return fs::exists(path("run.lcmlog.0")); })) << recorder.output();
  const auto bus = bus::make_lcm_bus(urls_[0].text());
  const auto recorded = [&](bool is_whole) {
    int count = 0;
    try {
      for (const auto& entry : fs::directory_iterator(folder_.path()))
        count += content_of(entry.path().string(), is_whole)["FT_WRENCH"];
    } catch (const std::exception&) {
      return -1;  // renamed meanwhile
    }
    return count;
  };
  publish(*bus, "FT_WRENCH", 0, 500);  // 113 bytes each
  ASSERT_TRUE(eventually([&] { return recorded(false) == 500; })) << recorded(false);
  EXPECT_TRUE(fs::exists(path("run.lcmlog.5")));
  EXPECT_FALSE(fs::exists(path("run.lcmlog.6")));
  recorder.send(SIGHUP);
  EXPECT_TRUE(eventually([&] { return fs::exists(path("run.lcmlog.6")); }));
  recorder.send(SIGTERM);
  EXPECT_EQ(recorder.wait(seconds(20)), 0);
  EXPECT_EQ(recorded(true), 500);
}

TEST_F(Record, WhoIsKilledLeavesWhatWasFlushed) {
  ChildProcess recorder(
      command({"--only", "control", "--flush-interval", "10", path("run.lcmlog")}));
  ASSERT_TRUE(eventually([&] { return fs::exists(path("run.lcmlog")); }));
  publish(*bus::make_lcm_bus(urls_[0].text()), "FT_WRENCH", 0, 200);
  ASSERT_TRUE(
      eventually([&] { return content_of(path("run.lcmlog"), false)["FT_WRENCH"] == 200; }));
  recorder.send(SIGKILL);
  recorder.wait(seconds(20));
  EXPECT_EQ(content_of(path("run.lcmlog"))["FT_WRENCH"], 200);
}

TEST_F(Record, RefusesWhatItShouldAndSaysWhy) {
  std::ofstream(path("there.lcmlog")) << "precious";
  const auto refused = [&](const std::vector<std::string>& more, const std::string& word) {
    ChildProcess recorder(command(more));
    EXPECT_NE(recorder.wait(seconds(20)), 0) << recorder.output();
    EXPECT_NE(recorder.output().find(word), std::string::npos) << recorder.output();
  };
  refused({"--only", "control", path("there.lcmlog")}, "--force");
  refused({"-c", "(", path("run")}, "regular expression");
  refused({"--split-mb", "1", path("run")}, "--rotate");
  refused({"--only", "nonsense", path("run")}, "nonsense");
  refused({"--url", "control=udpm://1.2.3.4:5", path("run")}, "multicast");
  refused({"--min-free-mb", "1e12", path("run")}, "--min-free-mb");
  EXPECT_FALSE(fs::exists(path("run.control.lcmlog")));
}

}  // namespace
}  // namespace palpate
