// palpate-sim --fast and palpated --stepped as two processes, with all their messages recorded.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "core/math/random.hpp"
#include "core/math/rigid.hpp"
#include "rt/bus/event_log_reader.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/text.hpp"
#include "tests/process/lock_step/datagrams.hpp"
#include "tests/support/child_process.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using support::ChildProcess;
using support::Datagram;
using support::Datagrams;

const std::string kBin = PALPATE_BIN_DIR;
const std::string kSource = PALPATE_SOURCE_DIR;

/// Payload without the session, which is regenerated at each start.
std::vector<std::uint8_t> without_session(std::vector<std::uint8_t> payload) {
  // Fingerprint 8, utime 8, seq 4, session 8.
  std::fill(payload.begin() + 20, payload.begin() + 28, std::uint8_t{0});
  return payload;
}

/// Such payloads of a run, by channel.
using Record = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;

/// Forwards the control bus between the simulator's URL and the daemon's, and drops some of the
/// messages that lock-step repeats; records the messages of both.
class Relay {
 public:
  Relay(const std::string& sim_url, const std::string& daemon_url, const std::string& housekeeping,
        double loss)
      : sim_(sim_url), daemon_(daemon_url), housekeeping_(housekeeping), loss_(loss) {
    thread_ = std::thread([this] { work(); });
  }
  ~Relay() { stop(); }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  const Record& stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    return record_;
  }
  int lost() const { return lost_; }

 private:
  void work() {
    Datagram datagram;
    pollfd watched[] = {{sim_.descriptor(), POLLIN, 0},
                        {daemon_.descriptor(), POLLIN, 0},
                        {housekeeping_.descriptor(), POLLIN, 0}};
    while (!over_) {
      poll(watched, 3, 20);
      while (sim_.take(datagram)) pass(datagram, daemon_);
      while (daemon_.take(datagram)) pass(datagram, sim_);
      while (housekeeping_.take(datagram)) keep(datagram);
    }
  }

  void pass(const Datagram& datagram, Datagrams& to) {
    const std::string channel = datagram.channel();
    const bool repeated = channel == "SIM_TICK" || channel == "TICK_DONE";
    if (repeated && random_.uniform() < loss_) {
      ++lost_;
      return;
    }
    to.send(datagram);
    if (!repeated) keep(datagram);
  }

  void keep(const Datagram& datagram) {
    const std::vector<std::uint8_t> payload = datagram.payload();
    if (payload.size() < 28) return;
    record_[datagram.channel()].push_back(without_session(payload));
  }

  Datagrams sim_, daemon_, housekeeping_;
  double loss_;
  math::Random random_{11};
  Record record_;
  int lost_ = 0;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

struct Outcome {
  Record record;
  nlohmann::json sim;
  std::string daemon;  // its output
  int lost = 0;
};

/// One second of a scene; unless it moves by itself, the bar is pulled towards a target.
class LockStepProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      bus::make_lcm_bus(sim_url_)->start();
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
  }

  void command_daemon() const {
    const auto bus = bus::make_lcm_bus(daemon_url_);
    component_command_t start{};
    start.session = start.counter = 1;
    bus::put_text(start.slot, "all");
    bus::put_text(start.event, "start");
    bus::TypedPublisher<component_command_t>(*bus, "COMPONENT_COMMAND").publish(start);
    shape_target_t target{};
    target.session = target.revision = target.chunks = 1;
    bus::put_text(target.kind, "point");
    target.value_count = 3;
    const double point[] = {0.25, 0.03, 0.08};
    std::copy(std::begin(point), std::end(point), target.values);
    bus::TypedPublisher<shape_target_t>(*bus, "SHAPE_TARGET").publish(target);
  }

  Outcome run(double loss, const std::string& scene = "bar_long_soft_control.yaml") const {
    Outcome result;
    Relay relay(sim_url_, daemon_url_, housekeeping_url_, loss);
    const std::string housekeeping = "bus.housekeeping=" + housekeeping_url_;
    ChildProcess daemon({kBin + "/palpated", "--config",
                         kSource + "/rt/config/examples/bar_long_soft.yaml", "--stepped", "--set",
                         "bus.control=" + daemon_url_, "--set", housekeeping});
    for (int i = 0; i < 2000 && daemon.output().find("waits for start") == std::string::npos; ++i)
      std::this_thread::sleep_for(milliseconds(10));
    command_daemon();
    const auto summary = std::filesystem::temp_directory_path() /
                         ("palpate_lock_step_" + std::to_string(getpid()) + ".json");
    ChildProcess sim({kBin + "/palpate-sim", kSource + "/sim/scenes/" + scene, "--fast",
                      "--duration", "1", "--json", summary.string(), "--set",
                      "object.elements=[10, 1, 1]", "--set", "bus.control=" + sim_url_, "--set",
                      housekeeping});
    EXPECT_EQ(sim.wait(milliseconds(60000)), 0) << sim.output();
    daemon.send(SIGTERM);
    EXPECT_EQ(daemon.wait(milliseconds(10000)), 0) << daemon.output();
    std::this_thread::sleep_for(milliseconds(50));  // messages in transit to the recorder
    result.record = relay.stop();
    result.lost = relay.lost();
    result.daemon = daemon.output();
    result.sim = nlohmann::json::parse(std::ifstream(summary));
    std::filesystem::remove(summary);
    return result;
  }

  /// Truth, sensors, estimates and commands of two runs, byte by byte.
  static void expect_same(const Outcome& a, const Outcome& b) {
    for (const char* channel :
         {"TRUTH_SHAPE", "TRUTH_CONTACT", "FT_WRENCH", "IMU", "ROBOT_STATE", "HAND_STATE", "SHAPE",
          "ESTIMATE", "FEATURE", "CONTACTS", "TWIST_COMMAND"}) {
      ASSERT_TRUE(a.record.count(channel)) << channel;
      ASSERT_TRUE(b.record.count(channel)) << channel;
      const auto &first = a.record.at(channel), &second = b.record.at(channel);
      ASSERT_EQ(first.size(), second.size()) << channel;
      for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], second[i]) << channel << i;
    }
  }

  const std::string sim_url_ = support::private_url(0);
  const std::string daemon_url_ = support::private_url(1);
  const std::string housekeeping_url_ = support::private_url(2);
};

TEST_F(LockStepProcess, ARecordingHoldsWhatALockStepRunPublishes) {
  const std::string scene = "bar_long_soft_six_poses.yaml";
  const Outcome published = run(0, scene);
  const auto folder =
      std::filesystem::temp_directory_path() / ("palpate_recording_" + std::to_string(getpid()));
  ChildProcess sim({kBin + "/palpate-sim", kSource + "/sim/scenes/" + scene, "--record",
                    folder.string(), "--duration", "1", "--set", "object.elements=[10, 1, 1]"});
  ASSERT_EQ(sim.wait(milliseconds(60000)), 0) << sim.output();
  Record recorded;
  for (const char* log : {"sensors.log", "truth.log"}) {
    bus::EventLogReader reader((folder / log).string());
    while (const bus::LoggedEvent* event = reader.next()) {
      recorded[std::string(event->channel)].push_back(
          without_session({event->data, event->data + event->size}));
      if (std::string(event->channel) != "ROBOT_STATE") continue;
      // The log's time is that of the simulation: of the arrival, a few ms after the reading.
      std::int64_t read = 0;
      for (int i = 8; i < 16; ++i) read = read << 8 | event->data[i];
      ASSERT_EQ(event->utime % 1000, 0);
      ASSERT_GE(event->utime, read);
      ASSERT_LE(event->utime, read + 5000);
    }
  }
  std::filesystem::remove_all(folder);
  for (const char* channel :
       {"TRUTH_SHAPE", "TRUTH_CONTACT", "FT_WRENCH", "IMU", "ROBOT_STATE", "HAND_STATE"}) {
    ASSERT_TRUE(recorded.count(channel)) << channel;
    ASSERT_TRUE(recorded[channel] == published.record.at(channel)) << channel;
  }
}

TEST_F(LockStepProcess, ARecordingNeedsAMotion) {
  ChildProcess sim({kBin + "/palpate-sim", kSource + "/sim/scenes/bar_long_soft_control.yaml",
                    "--record", "nowhere"});
  EXPECT_EQ(sim.wait(milliseconds(60000)), 78);
  EXPECT_NE(sim.output().find("--record needs a scene with a motion"), std::string::npos)
      << sim.output();
  EXPECT_FALSE(std::filesystem::exists("nowhere"));
}

TEST_F(LockStepProcess, TwoRunsAreEqualToTheBitAndLostTicksChangeNothing) {
  const Outcome first = run(0);
  EXPECT_EQ(first.sim["ticks"], 1000);
  EXPECT_EQ(first.record.at("TRUTH_SHAPE").size(), 100u);
  EXPECT_EQ(first.sim["commands_lost"], 0);
  // The daemon's commands did move the arm.
  twist_command_t last{};
  const auto& bytes = first.record.at("TWIST_COMMAND").at(900);
  ASSERT_GT(last.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
  EXPECT_EQ(last.valid, 1);
  EXPECT_GT(Eigen::Map<const math::Vector6d>(last.twist).norm(), 1e-4) << first.daemon;
  EXPECT_NE(first.record.at("TRUTH_CONTACT").front(), first.record.at("TRUTH_CONTACT").back());
  expect_same(first, run(0));

  const Outcome lossy = run(0.05);
  EXPECT_GT(lossy.lost, 50);
  EXPECT_GE(lossy.sim["ticks_sent_again"], lossy.lost / 2);
  expect_same(first, lossy);
}

}  // namespace
}  // namespace palpate
