#pragma once

#include <optional>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"
#include "rt/daemon/crash_record.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/loop/fixed_rate_loop.hpp"

namespace palpate::daemon {

/// Limits of lateness for continuing, degraded operation and safe stop.
struct OverrunPolicy {
  double degraded_after = 6e-3;    // s of lateness within `window`
  double window = 20e-3;           // s
  double safe_stop_after = 20e-3;  // s without a command; the stop is latched
};

/// Sections `loop`, `inputs`, `record`, `bus` and `access` of the configuration.
struct Settings {
  loop::LoopOptions loop;
  OverrunPolicy overruns;
  FrozenAfter frozen_after;
  RecordSettings record;
  std::string control_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping_url = "udpm://239.255.76.68:7668?ttl=0";
  bus::ChannelNames channels;   // on both URLs
  int largest_message = 65000;  // bytes, of several fragments; 0: fragments are dropped
  std::optional<bus::Key> key;  // key of incoming and outgoing commands; empty: no authentication
  int shape_every = 10;         // cycles between two SHAPE messages
  int refactor_delay = 5;  // deterministic mode: cycles between requesting and installing a factor
  int replace_delay =
      200;  // deterministic mode: cycles between requesting and installing new components
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::daemon
