#pragma once

#include <palpate/touch_request_t.hpp>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::command {

/// The command touch: a guarded motion of the daemon, followed to its end.
class Touch {
 public:
  /// Adds the command and its options.
  void add_to(CLI::App& app);
  /// Starts the bus. Prints progress and result; an interrupt stops the motion. `timeout`: s, for
  /// an answer, and between two messages of the daemon. Returns the exit code.
  int run(bus::MessageBus& control, const bus::Access& access, double timeout) const;

 private:
  std::vector<double> direction_;
  touch_request_t request_{};
};

}  // namespace palpate::command
