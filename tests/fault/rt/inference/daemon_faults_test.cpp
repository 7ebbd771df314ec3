// A user's module that fails, hangs or returns invalid values while the daemon runs: detection,
// fallback and report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <palpate/biotac_t.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <thread>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"
#include "tests/support/torch_script/torch_script.hpp"

namespace palpate::daemon {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using torch_script::forward;

constexpr int kActive = 2, kDegraded = 3, kFaulted = 4;  // of health_t.state
/// Behaviour of a module once its first input is beyond 500.
constexpr const char* kThrows = "assert False, \"broken\"";
constexpr const char* kHangs = "while bool(x[0, 0] > 500):\n        z = z + 1";
constexpr const char* kNotFinite = "z = z / 0";
constexpr const char* kWrongSize = "z = torch.cat([z, z], 1)";

/// Outputs 0.2 N along z of `outputs` numbers until then.
std::string module(const std::string& misdeed, int outputs) {
  std::string answer = "0.0, 0.0, 0.2";
  for (int i = 3; i < outputs; ++i) answer += ", 0.0";
  return torch_script::module(forward("z = torch.tensor([[" + answer +
                                      "]])\n"
                                      "if bool(x[0, 0] > 500):\n    " +
                                      misdeed + "\nreturn z, state"));
}

/// A daemon on an in-process bus, with the user and the sensors at its other end.
class Cell {
 public:
  Cell(const config::Node& configuration, Mode mode)
      : hub_(bus::make_memory_hub()),
        users_(bus::make_memory_bus(hub_)),
        bus_(bus::make_memory_bus(hub_)),
        daemon_(configuration, *bus_, *bus_, mode, 1),
        mode_(mode) {
    bus_->start();
    bus::set_time(*hub_, now_ns_);
    command("start");
  }

  void command(const char* event) {
    component_command_t message{};
    message.session = 1;
    message.counter = ++counter_;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, event);
    bus::TypedPublisher<component_command_t>(*users_, "COMPONENT_COMMAND").publish(message);
  }

  template <class T>
  void say(const char* channel, T message) {
    message.session = 3;
    message.utime = now_ns_ / 1000;
    message.seq = ++seq_;
    bus::TypedPublisher<T>(*users_, channel).publish(message);
  }

  void tick() {
    bus::set_time(*hub_, now_ns_);
    bus::record(*hub_, &published_);
    daemon_.tick({now_ns_, now_ns_ / 1000, 0});
    bus::record(*hub_, nullptr);
    for (const bus::Published& message : published_) {
      const int size = static_cast<int>(message.data.size());
      if (message.channel == "CONTACTS") contacts.decode(message.data.data(), 0, size);
      if (message.channel == "HEALTH") health.decode(message.data.data(), 0, size);
      bytes.insert(bytes.end(), message.data.begin(), message.data.end());
      if (message.channel != "COMPONENT_EVENT") continue;
      component_event_t event{};
      event.decode(message.data.data(), 0, size);
      events.push_back(event);
    }
    published_.clear();
    now_ns_ += 1'000'000;
    if (mode_ == Mode::kRealTime) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }

  /// Ten ticks after a sample of the fingertip: every tenth electrode count, and the pressure.
  void touch(int electrodes, int pressure) {
    biotac_t sample{};
    sample.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
    sample.pac_count = 1;
    for (std::int16_t& count : sample.electrodes) count = static_cast<std::int16_t>(electrodes);
    sample.pdc = static_cast<std::int16_t>(pressure);
    say("BIOTAC_0", sample);
    for (int i = 0; i < 10; ++i) tick();
  }

  /// Texts of all events of this name of the sensing slot, one per line.
  std::string reported(const std::string& event) const {
    std::string text;
    for (const component_event_t& e : events)
      if (bus::get_text(e.slot) == std::string("sensing") && bus::get_text(e.event) == event)
        text += std::string(bus::get_text(e.instance)) + " " + bus::get_text(e.component) + " " +
                bus::get_text(e.reason) + "\n";
    return text;
  }
  std::string reason() const { return bus::get_text(health.reason); }
  double force(int axis) const { return contacts.count == 0 ? 0 : contacts.wrench[0][axis]; }

  contacts_t contacts{};
  health_t health{};
  std::vector<component_event_t> events;
  std::vector<std::uint8_t> bytes;

 private:
  std::shared_ptr<bus::MemoryHub> hub_;
  std::unique_ptr<bus::MessageBus> users_, bus_;
  Daemon daemon_;
  Mode mode_;
  std::vector<bus::Published> published_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::int64_t counter_ = 0;
  std::int32_t seq_ = 0;
};

class FaultyModel : public ::testing::Test {
 protected:
  FaultyModel()
      : folder_(fs::temp_directory_path() / ("palpate-faults-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    // 1 mN per count of pressure, along z.
    std::ofstream linear(folder_ / "linear.yaml");
    linear << "model:\n";
    for (const char axis : {'x', 'y', 'z'}) {
      linear << "  force_" << axis << ": [";
      for (int i = 0; i < 21; ++i) linear << (axis == 'z' && i == 20 ? "0.001" : "0") << ", ";
      linear << "]\n";
    }
  }
  ~FaultyModel() override { fs::remove_all(folder_); }

  config::Node fingertip(const std::string& misdeed, const std::string& more = "") const {
    inference::ModelCard card;
    card.name = "finger";
    card.rate = 100;
    card.states = 1;
    card.inputs = {{"e1", "count"}};
    card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
    torch_script::write((folder_ / "finger.pt").string(), module(misdeed, 3), card);
    return config::Node::load_file(
        PALPATE_SOURCE_DIR "/rt/config/examples/foam_bar_tactile.yaml",
        {"sensing=[{name: ring_finger, component: biotac_lstm, finger: 0, tare_samples: 1, "
         "model_file: " +
             (folder_ / "finger.pt").string() + more + "}]",
         "object.mesh={box: {size: [0.2, 0.04, 0.04], cells: [4, 1, 1]}}"});
  }
  std::string fallback() const {
    return ", fallback: biotac_linear, fallback_file: " + (folder_ / "linear.yaml").string();
  }

  /// Contact with 400 counts of pressure: the network's output, then the output once the network
  /// has failed.
  static void run_into_fault(Cell& cell) {
    cell.touch(0, 0);
    for (int i = 0; i < 20; ++i) cell.touch(400, 400);
    EXPECT_EQ(cell.health.state, kActive) << cell.reason();
    EXPECT_NEAR(cell.force(2), 0.2, 1e-6);
    EXPECT_EQ(cell.reported("model_fault"), "");
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (cell.reported("model_fault").empty() && std::chrono::steady_clock::now() < end)
      cell.touch(600, 400);
    for (int i = 0; i < 20; ++i) cell.touch(600, 400);
  }

  fs::path folder_;
};

TEST_F(FaultyModel, TheFallbackTakesOverWhereItFails) {
  for (const char* misdeed : {kThrows, kNotFinite, kWrongSize}) {
    Cell cell(fingertip(misdeed, fallback()), Mode::kDeterministic);
    run_into_fault(cell);
    EXPECT_NEAR(cell.force(2), 0.4, 1e-6) << misdeed;  // 400 counts of 1 mN
    EXPECT_EQ(cell.contacts.count, 1);
    EXPECT_EQ(cell.health.state, kDegraded);
    EXPECT_EQ(cell.reason(),
              "ring_finger: the network of the force fails or hangs: biotac_linear has taken over");
    EXPECT_THAT(cell.reported("model_fault"), HasSubstr("ring_finger biotac_lstm executor torch"));
    EXPECT_THAT(cell.reported("degraded"), HasSubstr("ring_finger biotac_lstm the network"));
    EXPECT_EQ(cell.health.model_late[0], 0) << "a failure is reported at once";

    // A reset gives the network another chance.
    cell.command("reset");
    cell.touch(0, 0);
    cell.command("start");
    for (int i = 0; i < 20; ++i) cell.touch(400, 400);
    EXPECT_EQ(cell.health.state, kActive) << cell.reason();
    EXPECT_NEAR(cell.force(2), 0.2, 1e-6);
  }
}

TEST_F(FaultyModel, WithoutAFallbackTheComponentFaults) {
  Cell cell(fingertip(kThrows), Mode::kDeterministic);
  run_into_fault(cell);
  EXPECT_EQ(cell.contacts.count, 0);
  EXPECT_EQ(cell.health.state, kFaulted);
  EXPECT_EQ(cell.reason(), "ring_finger: the network of the force fails or hangs");
  EXPECT_THAT(cell.reported("faulted"), HasSubstr("ring_finger biotac_lstm the network"));
}

TEST_F(FaultyModel, AHangIsLateThenAFaultAndTheDaemonEnds) {
  Cell cell(fingertip(kHangs, fallback() + ", wait_us: 50000"), Mode::kRealTime);
  run_into_fault(cell);
  EXPECT_GT(cell.health.model_late[0], 0);
  EXPECT_NEAR(cell.force(2), 0.4, 1e-6);
  EXPECT_EQ(cell.health.state, kDegraded);
  EXPECT_THAT(cell.reason(), HasSubstr("biotac_linear has taken over"));
  EXPECT_STREQ(bus::get_text(cell.health.model_executor[0]), "torch");
  EXPECT_THAT(cell.reported("model_fault"), HasSubstr("executor torch, model 0"));
  EXPECT_THAT(cell.reported("model_fault"), HasSubstr("late "));
}

TEST_F(FaultyModel, TheWristGoesOnWithItsPayload) {
  inference::ModelCard card;
  card.name = "wrist";
  card.rate = 100;
  card.states = 1;
  card.inputs = {{"acceleration_y", "m/s^2"}};  // of S, which is x of I
  card.outputs = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                  {"tx", "N m"}, {"ty", "N m"}, {"tz", "N m"}};
  card.payload = sensing::PayloadParameters{};
  card.payload->mass = 2;
  torch_script::write((folder_ / "wrist.pt").string(), module(kThrows, 6), card);
  Cell cell(
      config::Node::load_file(
          PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
          {"sensing=[{name: wrist, component: ft_rnnob, fallback: newton_euler, model_file: " +
           (folder_ / "wrist.pt").string() + "}]"}),
      Mode::kDeterministic);
  robot_state_t robot{};
  robot.joint_count = 7;
  robot.quaternion[0] = 1;
  ft_wrench_t reading{};
  reading.wrench[2] = 30;
  imu_t inertial{};
  inertial.acceleration[2] = 9.81;
  const auto run = [&](double acceleration, int ticks) {
    inertial.acceleration[0] = acceleration;
    for (int i = 0; i < ticks; ++i) {
      // Identical sensor readings do not count.
      reading.wrench[5] = inertial.angular_velocity[2] = i % 2 == 0 ? 1e-9 : -1e-9;
      cell.say("ROBOT_STATE", robot);
      cell.say("FT_WRENCH", reading);
      cell.say("IMU", inertial);
      cell.tick();
    }
    return std::hypot(cell.force(0), cell.force(1), cell.force(2));
  };
  const double before = run(0, 300);
  EXPECT_EQ(cell.reported("model_fault"), "");
  run(600, 30);
  const double after = run(0, 300);
  EXPECT_THAT(cell.reported("model_fault"), HasSubstr("wrist ft_rnnob executor torch"));
  EXPECT_THAT(cell.reported("degraded"), HasSubstr("payload"));
  EXPECT_GT(before, 1);
  // The network accounted for 0.2 N of the reading; the payload's weight is removed before and
  // after.
  EXPECT_NEAR(after - before, 0.2, 1e-3);
}

TEST_F(FaultyModel, ABadModelForAnotherPipelineLeavesARunningOneAlone) {
  const auto run = [&](bool disturbed) {
    Cell cell(fingertip(kThrows, ", wait_us: 0"), Mode::kDeterministic);
    cell.touch(0, 0);
    for (int i = 0; i < 30; ++i) {
      if (disturbed && i % 10 == 5) {
        const config::Node node = fingertip("z = z", ", executor: compiled");
        EXPECT_THROW(Cell(node, Mode::kDeterministic), config::Error);
        // The same for a damaged file that is to replace the running one.
        std::ofstream((folder_ / "finger.pt").string(), std::ios::app) << "more";
        const config::Node same = config::Node::load_file(
            PALPATE_SOURCE_DIR "/rt/config/examples/foam_bar_tactile.yaml",
            {"sensing=[{component: biotac_lstm, model_file: " + (folder_ / "finger.pt").string() +
             "}]"});
        EXPECT_THROW(Cell(same, Mode::kDeterministic), config::Error);
      }
      cell.touch(400, 10 * i);
    }
    EXPECT_EQ(cell.health.state, kActive);
    EXPECT_NEAR(cell.force(2), 0.2, 1e-6);
    return cell.bytes;
  };
  const std::vector<std::uint8_t> alone = run(false);
  EXPECT_GT(alone.size(), 10000u);
  EXPECT_TRUE(alone == run(true));
}

}  // namespace
}  // namespace palpate::daemon
