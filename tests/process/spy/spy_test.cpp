// palpate-spy on a virtual screen, with messages sent to it.

#include <gtest/gtest.h>

#include <atomic>
#include <palpate/biotac_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/shape_t.hpp>
#include <thread>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/process/spy/display.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate {
namespace {

using bus::wire::Injector;
using std::chrono::seconds;
using support::ChildProcess;

const std::string kSpy = std::string(PALPATE_BIN_DIR) + "/palpate-spy";

/// Publishes BIOTAC_2 on one bus, HEALTH and a SHAPE of one node on the other, until it is
/// destroyed.
class Messages {
 public:
  Messages(const std::string& control, const std::string& housekeeping)
      : thread_([this, control, housekeeping] { publish(control, housekeeping); }) {}
  ~Messages() {
    stop_ = true;
    thread_.join();
  }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

 private:
  void publish(const std::string& control_url, const std::string& housekeeping_url) {
    const auto control = bus::make_lcm_bus(control_url);
    const auto housekeeping = bus::make_lcm_bus(housekeeping_url);
    bus::TypedPublisher<biotac_t> fingertips(*control, "BIOTAC_2");
    bus::TypedPublisher<health_t> healths(*housekeeping, "HEALTH");
    bus::TypedPublisher<shape_t> shapes(*housekeeping, "SHAPE");
    biotac_t fingertip{};
    health_t health{};
    shape_t shape{};
    shape.node_count = 1;
    shape.xyz_count = 3;
    shape.xyz = {0, 0, 0};
    bus::HeaderStamper stamp(5);
    while (!stop_) {
      const auto send = [&](auto& publisher, auto& message) {
        stamp.put(message, bus::wall_clock_us());
        publisher.publish(message);
      };
      send(fingertips, fingertip);
      send(healths, health);
      send(shapes, shape);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class Spy : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSpy))
      GTEST_SKIP() << "built without Java: default-jdk-headless, liblcm-java, libjchart2d-java";
    if (!Display::is_installed()) GTEST_SKIP() << "Xvfb is absent; install xvfb";
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
    display_ = std::make_unique<Display>();
    ASSERT_TRUE(display_->works()) << display_->complaint();
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{kSpy, "--url", urls_[0].text(), "--url", urls_[1].text()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static bool says(const ChildProcess& spy, const std::string& words) {
    return eventually([&] { return spy.output().find(words) != std::string::npos; });
  }

  bus::UdpmUrl urls_[2];
  std::unique_ptr<Display> display_;
};

TEST_F(Spy, ShowsEveryTypeAmongPacketsThatEndOthers) {
  ChildProcess spy(command({"--seconds", "10"}));
  ASSERT_TRUE(says(spy, "listens to")) << spy.output();
  EXPECT_NE(spy.output().find("LCM types"), std::string::npos) << spy.output();
  Injector injector(urls_[1]);
  inject::PacketSource source(3, inject::malformed_kinds(), inject::usual_targets());
  for (int i = 0; i < 600; ++i) {
    const std::vector<std::uint8_t>& packet = source.next();
    ASSERT_TRUE(injector.send(packet.data(), packet.size()));
    if (i % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Messages messages(urls_[0].text(), urls_[1].text());
  EXPECT_TRUE(eventually([&] { return display_->dark_pixels() > 500 || !spy.running(); }));
  EXPECT_TRUE(spy.running()) << "the table's text has not been seen; " << spy.output();
  EXPECT_EQ(spy.wait(seconds(150)), 0) << spy.output();

  const std::string words = spy.output();
  for (const char* line :
       {"BIOTAC_2: palpate.biotac_t, ", "HEALTH: palpate.health_t, ", "SHAPE: palpate.shape_t, "})
    EXPECT_NE(words.find(line), std::string::npos) << line << " is not in " << words;
  EXPECT_NE(words.find("rejected "), std::string::npos) << words;
  EXPECT_EQ(words.find("rejected 0 datagrams"), std::string::npos) << words;
}

TEST_F(Spy, OpensTheFieldsOfAChannelByTheMouse) {
  if (output_of("xdotool version").empty()) GTEST_SKIP() << "xdotool is absent; install xdotool";
  ChildProcess spy(command({}));
  ASSERT_TRUE(says(spy, "listens to")) << spy.output();
  const Messages messages(urls_[0].text(), urls_[1].text());
  ASSERT_TRUE(eventually([] { return !Display::window("LCM Spy").empty(); }));
  const std::string table = Display::window("LCM Spy");
  // Rows in alphabetical order: BIOTAC_2, HEALTH, SHAPE.
  constexpr int kX = 60, kFirstRow = 28, kRow = 16;
  const char* const channels[] = {"BIOTAC_2", "HEALTH"};
  for (int row = 0; row < 2; ++row) {
    // The effect of a click is visible only once the row exists and is drawn: retry.
    bool opened = false;
    for (int attempt = 0; attempt < 20 && !opened; ++attempt) {
      Display::click(table, kX, kFirstRow + row * kRow, "--repeat 2 --delay 60 1");
      opened = eventually([&] { return !Display::window(channels[row]).empty(); }, seconds(3));
    }
    EXPECT_TRUE(opened) << channels[row] << ": " << spy.output();
  }
  EXPECT_TRUE(spy.running()) << spy.output();
}

TEST_F(Spy, RefusesWhatItShouldAndSaysWhy) {
  const auto refused = [](const std::vector<std::string>& more, const std::string& words) {
    std::vector<std::string> all{kSpy};
    all.insert(all.end(), more.begin(), more.end());
    ChildProcess spy(all);
    EXPECT_EQ(spy.wait(seconds(60)), 1) << spy.output();
    EXPECT_NE(spy.output().find(words), std::string::npos) << spy.output();
  };
  refused({"--nonsense"}, "unknown");
  refused({"--url", "udpm://10.0.0.1:1"}, "multicast");
  refused({"--seconds"}, "needs a value");
  refused({"--seconds", "-1"}, "above zero");
  unsetenv("DISPLAY");
  refused({}, "DISPLAY");
  ChildProcess version({kSpy, "--version"});
  EXPECT_EQ(version.wait(seconds(20)), 0);
  EXPECT_EQ(version.output(), std::string(PALPATE_VERSION) + "\n");
}

}  // namespace
}  // namespace palpate
