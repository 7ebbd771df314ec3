#include "rt/daemon/settings.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rt/bus/udpm_url.hpp"
#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"

namespace palpate::daemon {
namespace {

void check_url(const config::Node& bus, const char* key, const std::string& url) {
  try {
    palpate::bus::parse_udpm_url(url);
  } catch (const std::invalid_argument& error) {
    bus.fail(key, error.what());
  }
}

}  // namespace

Settings read_settings(const config::Node& root) {
  Settings settings;
  const config::Node loop = root.child_or_empty({"loop", "", "cycle, punctuality and telemetry"});
  settings.loop.period =
      loop.number(
          {"period_ms", "ms", "of a cycle, which is the time step of dynamic models as well"},
          {0.25, 100}, 1.0) *
      1e-3;
  settings.loop.fifo_priority =
      loop.integer({"fifo_priority", "", "SCHED_FIFO priority of the loop; 0: ordinary scheduling"},
                   {0, 98}, settings.loop.fifo_priority);
  settings.loop.cpu = loop.integer({"cpu", "", "processor that the loop is bound to; -1: any"},
                                   {-1, 1023}, settings.loop.cpu);
  settings.loop.lock_memory =
      loop.flag({"lock_memory", "", "whether all memory is locked and touched before the start"},
                settings.loop.lock_memory);

  OverrunPolicy& overruns = settings.overruns;
  overruns.degraded_after =
      loop.number({"degraded_after_ms", "ms",
                   "of lateness within overrun_window_ms that make the daemon degraded"},
                  {1, 1e4}, 6) *
      1e-3;
  overruns.window =
      loop.number({"overrun_window_ms", "ms", "in which lateness is added up"}, {1, 1e4}, 20) *
      1e-3;
  overruns.safe_stop_after =
      loop.number({"safe_stop_after_ms", "ms",
                   "without a command after which a safe stop is latched until reset"},
                  {1, 1e4}, 20) *
      1e-3;
  settings.refactor_delay = loop.integer(
      {"refactor_delay", "cycles", "deterministic mode: between asking for a factor and taking it"},
      {1, 1000}, settings.refactor_delay);
  settings.replace_delay =
      loop.integer({"replace_delay", "cycles",
                    "deterministic mode: between asking for new components and taking them"},
                   {1, 100000}, settings.replace_delay);
  const double shape_rate = loop.number({"shape_rate", "Hz", "of SHAPE"}, {1, 1000}, 100);
  settings.shape_every =
      std::max(1, static_cast<int>(std::lround(1 / (shape_rate * settings.loop.period))));

  const config::Node frozen = root.child_or_empty({"inputs", "", "checks of what comes in"})
                                  .child_or_empty({"frozen_after_ms", "",
                                                   "time after which a sensor that repeats the "
                                                   "same numbers counts as silent; 0: never"});
  const auto read_frozen = [&frozen](const char* key, double& seconds) {
    const config::Key declared(key, "ms", "of the same numbers; 0: it may stand still");
    seconds = frozen.number(declared, {0, 1e6}, seconds * 1e3) * 1e-3;
  };
  read_frozen("force_torque", settings.frozen_after.force_torque);
  read_frozen("inertial", settings.frozen_after.inertial);
  read_frozen("biotac", settings.frozen_after.biotac);
  read_frozen("fingertip", settings.frozen_after.fingertip);
  read_frozen("robot", settings.frozen_after.robot);

  const config::Node record = root.child_or_empty(
      {"record", "",
       "record of the last seconds, an LCM log, written at a fault, a crash and SIGUSR1"});
  if (record.has("folder"))
    settings.record.folder =
        record.path({"folder", "", "folder of the records; absent: none are made"});
  settings.record.seconds =
      record.number({"seconds", "s", "that a record holds"}, {0.1, 60}, settings.record.seconds);
  settings.record.keep = record.integer({"keep", "", "records in the folder; the oldest go"},
                                        {1, 10000}, settings.record.keep);

  const config::Node bus = root.child_or_empty({"bus", "", "LCM URLs"});
  settings.control_url = bus.text(
      {"control", "", "sensors, robot, targets, commands and what is published every cycle"},
      settings.control_url);
  settings.housekeeping_url =
      bus.text({"housekeeping", "", "SHAPE, SHAPE_MESH, HEALTH, CONFIG and COMPONENT_EVENT"},
               settings.housekeeping_url);
  check_url(bus, "control", settings.control_url);
  check_url(bus, "housekeeping", settings.housekeeping_url);
  settings.largest_message = config::read_largest_message(bus);
  settings.channels = config::read_channel_names(bus);
  settings.key = config::read_key(root);
  return settings;
}

}  // namespace palpate::daemon
