#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/tools/bridge/common/memory_stream.hpp"
#include "tools/driver/arm.hpp"

namespace palpate::ur_bridge {

/// What a controller of Universal Robots does, in virtual time: the server side of RTDE, version 2,
/// which refuses everything that the protocol does not allow; a program of
/// follow_velocities.script; six joints. The members are faults.
class MockController {
 public:
  using Pipe = bridge::Pipe;
  static constexpr double kLag = 0.002;  // s, of the joints
  static constexpr double kBrakes = 30;  // rad/s^2, of its own stops
  static constexpr int kStartUp = 80;    // ms until a program runs

  explicit MockController(const driver::Joints& q, int period_ms = 2);

  std::unique_ptr<bridge::Stream> rtde_stream() { return connect(rtde_, "mock:30004"); }
  std::unique_ptr<bridge::Stream> script_stream() { return connect(script_, "mock:30002"); }

  /// Once per ms.
  void step(std::int64_t now_ns);
  /// As by switching it off and on.
  void restart();
  /// A person unlocks the stop; the program has ended (emergency) or continues (protective).
  void release_stops();
  /// Another program takes the place of the present one.
  void run_other_program();
  void stop_program() { runs_.reset(), runtime_ = 1; }

  const driver::Joints& q() const { return q_; }
  double speed() const { return dq_.lpNorm<Eigen::Infinity>(); }  // rad/s, of the fastest joint
  const std::string& violation() const { return violation_; }     // of the protocol, by the client
  int programs() const { return programs_; }                      // started
  int commands() const { return commands_; }                      // packages of inputs
  std::uint32_t runtime() const { return runtime_; }
  std::vector<double>& added(const std::string& name) { return added_[name]; }

  bool is_absent = false;  // the network is cut
  bool is_mute = false;    // sends no data
  bool has_nan = false;    // in its positions
  bool refuses_version = false, has_registers_in_use = false, has_other_type = false;
  bool is_remote = true;      // takes programs
  std::int64_t delay_ns = 0;  // of what it sends
  bool is_emergency_stopped = false, is_protectively_stopped = false, is_paused = false;
  std::int32_t robot_mode = 7;
  std::uint32_t major = 5;

 private:
  struct Script {
    int first = 0, run = 0, missed = 0, most_missed = 0, begins_in_ms = 0;
    double acceleration = 0, most_speed = 0;
    std::int32_t counter = 0;
    bool has_begun = false, stops = false;
  };

  struct Recipe {
    std::string name;
    int size = 0;  // bytes
    bool is_register = false;
  };

  std::unique_ptr<bridge::Stream> connect(Pipe& pipe, const std::string& name);
  void serve();
  void handle(std::uint8_t type, const std::vector<std::uint8_t>& fields);
  void answer(std::uint8_t type, const std::vector<std::uint8_t>& fields);
  void setup(std::uint8_t type, const std::string& names, std::vector<Recipe>& recipe);
  void take_inputs(const std::vector<std::uint8_t>& fields);
  void take_script();
  void run_script();
  void move(const driver::Joints& wanted, double acceleration);
  void publish();
  void violate(const std::string& what);
  void read(const std::string& name, std::array<double, 6>& values) const;

  int period_ms_;
  std::int64_t now_ns_ = 0, born_ns_ = 0;
  driver::Joints q_, dq_, wanted_;
  Pipe rtde_, script_;
  std::vector<std::uint8_t> incoming_;
  std::string text_;  // of the script, as far as it has come
  int phase_ = 0;     // of the setup: 1 version, 2 outputs, 3 inputs, 4 started
  std::vector<Recipe> outputs_, inputs_;
  double rate_ = 0;
  std::map<std::string, double> registers_;
  std::map<std::string, std::vector<double>> added_;  // values of other outputs
  std::optional<Script> runs_;
  std::uint32_t runtime_ = 1;
  std::string violation_;
  int programs_ = 0, commands_ = 0;
};

}  // namespace palpate::ur_bridge
