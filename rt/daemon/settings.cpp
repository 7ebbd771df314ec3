#include "rt/daemon/settings.hpp"

#include <algorithm>
#include <cmath>

#include "rt/config/key_file.hpp"

namespace palpate::daemon {

Settings read_settings(const config::Node& root) {
  Settings settings;
  const config::Node loop = root.child_or_empty("loop");
  settings.loop.period = loop.number("period_ms", {0.25, 100}, 1.0) * 1e-3;
  settings.loop.fifo_priority = loop.integer("fifo_priority", {0, 98}, settings.loop.fifo_priority);
  settings.loop.cpu = loop.integer("cpu", {-1, 1023}, settings.loop.cpu);
  settings.loop.lock_memory = loop.flag("lock_memory", settings.loop.lock_memory);

  OverrunPolicy& overruns = settings.overruns;
  overruns.degraded_after = loop.number("degraded_after_ms", {1, 1e4}, 6) * 1e-3;
  overruns.window = loop.number("overrun_window_ms", {1, 1e4}, 20) * 1e-3;
  overruns.safe_stop_after = loop.number("safe_stop_after_ms", {1, 1e4}, 20) * 1e-3;
  settings.refactor_delay = loop.integer("refactor_delay", {1, 1000}, settings.refactor_delay);
  settings.replace_delay = loop.integer("replace_delay", {1, 100000}, settings.replace_delay);
  const double shape_rate = loop.number("shape_rate", {1, 1000}, 100);
  settings.shape_every =
      std::max(1, static_cast<int>(std::lround(1 / (shape_rate * settings.loop.period))));

  const config::Node frozen = root.child_or_empty("inputs").child_or_empty("frozen_after_ms");
  const auto read_frozen = [&frozen](const char* key, double& seconds) {
    seconds = frozen.number(key, {0, 1e6}, seconds * 1e3) * 1e-3;
  };
  read_frozen("force_torque", settings.frozen_after.force_torque);
  read_frozen("inertial", settings.frozen_after.inertial);
  read_frozen("biotac", settings.frozen_after.biotac);
  read_frozen("robot", settings.frozen_after.robot);

  const config::Node record = root.child_or_empty("record");
  if (record.has("folder")) settings.record.folder = record.path("folder");
  settings.record.seconds = record.number("seconds", {0.1, 60}, settings.record.seconds);
  settings.record.keep = record.integer("keep", {1, 10000}, settings.record.keep);

  const config::Node bus = root.child_or_empty("bus");
  settings.control_url = bus.text("control", settings.control_url);
  settings.housekeeping_url = bus.text("housekeeping", settings.housekeeping_url);
  settings.key = config::read_key(root);
  return settings;
}

}  // namespace palpate::daemon
