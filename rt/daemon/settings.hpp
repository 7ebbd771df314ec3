#pragma once

#include <optional>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"
#include "rt/daemon/crash_record.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/loop/fixed_rate_loop.hpp"

namespace palpate::daemon {

/// Lateness within which the loop goes on, degrades, or stops the robot.
struct OverrunPolicy {
  double degraded_after = 6e-3;    // s of lateness within `window`
  double window = 20e-3;           // s
  double safe_stop_after = 20e-3;  // s without a command; latched
};

/// Sections `loop`, `inputs`, `record`, `bus` and `access`.
struct Settings {
  loop::LoopOptions loop;
  OverrunPolicy overruns;
  FrozenAfter frozen_after;
  RecordSettings record;
  std::string control_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping_url = "udpm://239.255.76.68:7668?ttl=0";
  std::optional<bus::Key> key;  // of commands, in and out; none: nothing is checked
  int shape_every = 10;         // cycles between two SHAPE messages
  int refactor_delay = 5;   // deterministic mode: cycles between asking for a factor and taking it
  int replace_delay = 200;  // likewise for new components
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::daemon
