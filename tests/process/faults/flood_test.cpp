// Message floods, on another port, on another channel of the same port, and on the same channel.

#include "tests/process/faults/fault_process.hpp"

namespace palpate {
namespace {

/// PALPATE_FLOOD_SECONDS=60, PALPATE_FLOOD_RATE=100000 for the long run.
class Flood : public FaultProcess {
 protected:
  void SetUp() override {
    FaultProcess::SetUp();
    if (IsSkipped()) return;
    daemon_ = std::make_unique<ChildProcess>(patient_command());
    health_t health{};
    ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
        << daemon_->output();
    robot_ = std::make_unique<Robot>(control_url_, true);
    ASSERT_TRUE(activate()) << daemon_->output();
    send_target();
    watch_for(std::min(6, seconds()));  // to the target, if there is time
  }
  void TearDown() override {
    robot_.reset();
    daemon_.reset();
    FaultProcess::TearDown();
  }

  static int seconds() { return amount("PALPATE_FLOOD_SECONDS", 2); }

  /// The same time without the flood, then with it.
  std::pair<Seen, Seen> compare(const std::string& url, const std::vector<std::string>& what) {
    const Seen quiet = watch_for(seconds());
    std::vector<std::string> words = {
        kInjector,   "flood",
        "--url",     url,
        "--seconds", std::to_string(seconds()),
        "--rate",    std::to_string(amount("PALPATE_FLOOD_RATE", 20000))};
    words.insert(words.end(), what.begin(), what.end());
    ChildProcess injector(words);
    const Seen flooded = watch([&] { return !injector.running(); });
    EXPECT_EQ(injector.wait(milliseconds(0)), 0);
    print("quiet", quiet);
    print("flooded", flooded);
    const std::string output = injector.output();
    std::printf("%s", output.substr(output.rfind('\r') + 1).c_str());
    EXPECT_TRUE(daemon_->running()) << daemon_->output();
    EXPECT_EQ(flooded.not_finite, 0);
    EXPECT_LE(flooded.largest_speed, 1.001 * kSpeedLimit);
    // The loop continues, at whatever rate a machine short of processors allows.
    EXPECT_GT(flooded.commands, quiet.commands / 4);
    return {quiet, flooded};
  }

  std::unique_ptr<ChildProcess> daemon_;
  std::unique_ptr<Robot> robot_;
};

TEST_F(Flood, OnAnotherPortIsNotHeard) {
  const auto [quiet, flooded] = compare(support::private_url(2), {});
  const health_t after = health_now();
  EXPECT_LT(flooded.datagrams / flooded.seconds, 1.5 * quiet.datagrams / quiet.seconds + 1000)
      << "none of it reached the daemon";
  EXPECT_TRUE(after.state == 2 || after.state == 3) << bus::get_text(after.reason);
}

TEST_F(Flood, OnAnotherChannelIsCounted) {
  const auto [quiet, flooded] = compare(control_url_, {});
  const health_t after = health_now();
  EXPECT_GT(flooded.datagrams / flooded.seconds, quiet.datagrams / quiet.seconds + 1000);
  EXPECT_TRUE(after.state == 2 || after.state == 3) << bus::get_text(after.reason);
}

TEST_F(Flood, OfCommandsDoesNotHoldUpTheLoop) {
  compare(control_url_, {"--channel", "COMPONENT_COMMAND", "--typed"});
}

TEST_F(Flood, OfWrenchesDoesNotHoldUpTheLoop) {
  compare(control_url_, {"--channel", "FT_WRENCH", "--typed"});
}

}  // namespace
}  // namespace palpate
