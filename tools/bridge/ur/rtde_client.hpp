#pragma once

#include <deque>
#include <memory>

#include "packages.hpp"
#include "tools/bridge/common/stream.hpp"

namespace palpate::ur_bridge {

/// Connects to a controller's RTDE server, agrees on version 2 and the variables, and receives its
/// data; begins again after every failure. Never waits.
class RtdeClient {
 public:
  struct Options {
    std::vector<Variable> outputs, inputs;
    double rate = 500;     // 1/s, of the outputs
    int oldest_major = 3;  // version of the controller's software: 3 (CB3), 5 (e-Series), ...
  };

  RtdeClient(std::unique_ptr<bridge::Stream> stream, Options options);

  /// Once per cycle: continues to connect, and receives. `now_ns`: any steady clock.
  void poll(std::int64_t now_ns);
  /// Outputs in the order of the options, valid until the next call; nullptr if there are none.
  const std::uint8_t* take();
  int output_size() const { return output_size_; }

  /// Whether data may come, and inputs be sent.
  bool is_running() const { return phase_ == Phase::kRunning; }
  /// A package of inputs: their values, in the order of the options, are to be put.
  PackageWriter& begin_inputs();
  void send_inputs();

  /// What has happened, for the user; empty if there is nothing new.
  std::string next_remark();

 private:
  enum class Phase {
    kWaiting,
    kConnecting,
    kVersion,
    kController,
    kOutputs,
    kInputs,
    kStart,
    kRunning
  };

  void request(PackageType type);
  void handle(PackageType type, PackageReader& reader);
  void enter(Phase phase);
  void remark(const std::string& text);
  /// Closes the connection, and connects again later.
  void fail(const std::string& why);
  void fail_answer(const std::string& to) { fail("its answer to " + to + " is malformed"); }

  std::unique_ptr<bridge::Stream> stream_;
  Options options_;
  int output_size_;
  Phase phase_ = Phase::kWaiting;
  std::int64_t now_ns_ = 0, deadline_ns_ = 0;
  std::uint8_t output_recipe_ = 0, input_recipe_ = 0;
  std::vector<std::uint8_t> received_;
  int begin_ = 0, end_ = 0;  // of received_, what has not been handled
  PackageWriter writer_{PackageType::kData};
  std::deque<std::string> remarks_;
  std::string last_remark_;
};

}  // namespace palpate::ur_bridge
