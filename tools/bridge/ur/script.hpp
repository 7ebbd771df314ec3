#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "tools/bridge/common/stream.hpp"

namespace palpate::ur_bridge {

/// What follow_velocities.script is to contain.
struct ScriptNumbers {
  int first = 24;            // register
  std::int32_t run = 1;      // number of the run, not 0
  double acceleration = 10;  // rad/s^2, of speedj and of the stop
  double most_speed = 3.2;   // rad/s, of a joint
  double watchdog = 0.04;    // s without a new command until it stops
};

/// The text with each $NAME replaced. Throws std::invalid_argument for a name that is not known or
/// not there.
std::string fill_script(const std::string& text, const ScriptNumbers& numbers);

/// Sends a program to the controller's interface for scripts. Never waits.
class ScriptSender {
 public:
  explicit ScriptSender(std::unique_ptr<bridge::Stream> stream) : stream_(std::move(stream)) {}

  void send(std::string script);
  /// Once per cycle. The connection stays open until end(), as the controller writes its state to
  /// it: if it were closed with that unread, the script could be lost.
  void poll();
  void end() { stream_->close(); }

 private:
  std::unique_ptr<bridge::Stream> stream_;
  std::string script_;  // what is to be sent
};

}  // namespace palpate::ur_bridge
