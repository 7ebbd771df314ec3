// palpated with a user's module that hangs: it continues, and it terminates on request.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <palpate/biotac_t.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/health_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/text.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/torch_script/torch_script.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using support::ChildProcess;
using ::testing::HasSubstr;

class LearnedModelProcess : public ::testing::Test {
 protected:
  LearnedModelProcess()
      : folder_(fs::temp_directory_path() / ("palpate-hang-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~LearnedModelProcess() override { fs::remove_all(folder_); }

  void SetUp() override {
    try {
      control_ = bus::make_lcm_bus(control_url_);
      housekeeping_ = bus::make_lcm_bus(housekeeping_url_);
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
    health_ = std::make_unique<bus::TypedSubscription<health_t>>(*housekeeping_, "HEALTH", 8);
    control_->start();
    housekeeping_->start();
  }

  void TearDown() override {
    if (control_) control_->stop();
    if (housekeeping_) housekeeping_->stop();
  }

  /// A daemon with one fingertip of this module.
  std::vector<std::string> command(const std::string& body) const {
    inference::ModelCard card;
    card.name = "finger";
    card.rate = 100;
    card.states = 1;
    card.inputs = {{"e1", "count"}};
    card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
    const std::string path = (folder_ / "finger.pt").string();
    torch_script::write(path, torch_script::module(torch_script::forward(body)), card);
    return {std::string(PALPATE_BIN_DIR) + "/palpated",
            "--config",
            PALPATE_SOURCE_DIR "/rt/config/examples/foam_bar_tactile.yaml",
            "--set",
            "bus.control=" + control_url_,
            "--set",
            "bus.housekeeping=" + housekeeping_url_,
            "--set",
            "sensing=[{name: ring_finger, component: biotac_lstm, tare_samples: 1, model_file: " +
                path + "}]",
            "--set",
            "loop.safe_stop_after_ms=10000"};
  }

  void start() {
    component_command_t message{};
    message.session = 42;
    message.counter = 1;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, "start");
    bus::TypedPublisher<component_command_t>(*control_, "COMPONENT_COMMAND").publish(message);
  }

  /// Contact of the fingertip with this many counts until HEALTH satisfies the condition, for at
  /// most 30 s.
  template <class Wish>
  bool touch_until(int counts, Wish wish) {
    bus::TypedPublisher<biotac_t> fingertip(*control_, "BIOTAC_0");
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    std::int64_t arrival_ns = 0;
    while (std::chrono::steady_clock::now() < end) {
      biotac_t sample{};
      sample.session = 3;
      sample.seq = ++seq_;
      sample.utime = 10'000 * seq_;
      sample.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
      sample.pac_count = 1;
      for (std::int16_t& count : sample.electrodes) count = static_cast<std::int16_t>(counts);
      sample.tac = static_cast<std::int16_t>(seq_ % 2);  // identical samples do not count
      fingertip.publish(sample);
      std::this_thread::sleep_for(milliseconds(10));
      while (health_->take(last_, arrival_ns))
        if (wish(last_)) return true;
    }
    return false;
  }

  fs::path folder_;
  std::string control_url_ = support::private_url(0);
  std::string housekeeping_url_ = support::private_url(1);
  std::unique_ptr<bus::MessageBus> control_, housekeeping_;
  std::unique_ptr<bus::TypedSubscription<health_t>> health_;
  health_t last_{};
  int seq_ = 0;
};

TEST_F(LearnedModelProcess, EndsCleanlyThoughAModelHangs) {
  ChildProcess daemon(
      command("z = torch.zeros([1, 3]) + 0.2\n"
              "while bool(x[0, 0] > 500):\n    z = z + 1\nreturn z, state"));
  ASSERT_TRUE(touch_until(0, [](const health_t& h) { return h.cycles > 100; })) << daemon.output();
  start();
  ASSERT_TRUE(touch_until(0, [](const health_t& h) { return h.model_steps[0] > 20; }));
  ASSERT_TRUE(touch_until(1000, [](const health_t& h) { return h.state == 4; }));
  EXPECT_THAT(bus::get_text(last_.reason), HasSubstr("ring_finger: the network of the force"));
  EXPECT_GT(last_.model_late[0], 0);
  const std::int64_t cycles = last_.cycles;
  ASSERT_TRUE(touch_until(0, [&](const health_t& h) { return h.cycles > cycles + 200; }))
      << "the loop stands still";
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(20000)), 0) << daemon.output();
  EXPECT_THAT(daemon.output(), HasSubstr("ring_finger model_fault: executor torch"));
}

TEST_F(LearnedModelProcess, RefusesAModelThatHangsAtOnceWith78) {
  ChildProcess daemon(command("while True:\n    x = x + 1\nreturn x, state"));
  EXPECT_EQ(daemon.wait(milliseconds(60000)), 78) << daemon.output();
  EXPECT_THAT(daemon.output(), ::testing::ContainsRegex("finger.pt: libtorch .* within [0-9]+"));
}

}  // namespace
}  // namespace palpate
