// palpated: estimates and controls the shape of a soft object. See README.md and --help.

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "rt/bus/instance_lock.hpp"
#include "rt/bus/lcm_bus.hpp"
#include "rt/config/command_line.hpp"
#include "rt/daemon/daemon.hpp"
#include "rt/daemon/plugin_watchdog.hpp"
#include "rt/daemon/service_manager.hpp"
#include "rt/daemon/stepped_clock.hpp"

namespace {

using palpate::bus::wall_clock_us;
using palpate::daemon::Daemon;
using palpate::daemon::Mode;
using palpate::daemon::Now;
using palpate::daemon::PluginWatchdog;

/// Makes spdlog write from a separate thread and drop lines if its queue is full, so that a full
/// disk or a blocked journal never delays the daemon. Block signals before this call.
void start_log() {
  constexpr std::size_t kRoom = 1024;  // lines
  spdlog::init_thread_pool(kRoom, 1);
  spdlog::set_default_logger(
      spdlog::create_async_nb<spdlog::sinks::stdout_color_sink_mt>("palpated"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
}

/// Waits briefly for the last lines to be written; if that fails, ends the process without them.
/// Otherwise returns the exit code.
int end_log(int exit_code) {
  auto written = std::make_shared<std::promise<void>>();
  auto future = written->get_future();
  std::thread([written] {
    spdlog::shutdown();
    written->set_value();
  }).detach();
  if (future.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready)
    _exit(exit_code);
  return exit_code;
}

/// Blocks, in all threads, the signals that end the program or request a record; wait_for_end()
/// receives them.
sigset_t block_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  return set;
}

/// Logs the events of the loop.
void log_events(Daemon& daemon, palpate::daemon::LoopWatch& watch) {
  palpate::daemon::EventRecord record;
  while (daemon.take_record(record)) {
    const char* component = record.component.data();
    const char* reason = record.reason.data();
    const std::string line = fmt::format("{}{}{}{}{}", component, *component != '\0' ? " " : "",
                                         record.event.data(), *reason != '\0' ? ": " : "", reason);
    spdlog::info(line);
    watch.set_status(line);
  }
}

/// Writes a record requested by a fault or a user, if available.
void write_record(Daemon& daemon) {
  if (daemon.crash_record() == nullptr) return;
  try {
    const std::string path = daemon.crash_record()->write_handed_over();
    if (!path.empty()) spdlog::warn("record of the last seconds: {}", path);
  } catch (const std::runtime_error& error) {
    spdlog::error("no record: {}", error.what());
  }
}

/// Supervises the loop until a signal requests the end or the loop has ended. `cycles`: count of
/// the loop.
void wait_for_end(const sigset_t& signals, Daemon& daemon, const PluginWatchdog& watchdog,
                  const std::atomic<std::int64_t>& cycles) {
  using palpate::daemon::LoopWatch;
  const timespec interval{0, 50'000'000};
  palpate::daemon::ServiceManager manager;
  LoopWatch watch(manager);
  while (watchdog.hung() == nullptr) {
    const int signal = sigtimedwait(&signals, nullptr, &interval);
    log_events(daemon, watch);
    write_record(daemon);
    switch (watch.look(palpate::loop::monotonic_ns(), cycles)) {
      case LoopWatch::Verdict::kStalled:
        spdlog::error("the loop does not move");
        break;
      case LoopWatch::Verdict::kRecovered:
        spdlog::warn("the loop moves again");
        break;
      case LoopWatch::Verdict::kNothing:
        break;
    }
    if (signal == SIGUSR1) {
      if (daemon.crash_record() != nullptr) daemon.crash_record()->request();
    } else if (signal > 0) {
      spdlog::info("{}: ends", strsignal(signal));
      break;
    }
  }
  manager.notify("STOPPING=1");
}

/// Pairs of a fraction of cycles and the latency, us, which it exceeds; four fractions per decade.
nlohmann::json tail(const palpate::loop::LatencyHistogram& latency) {
  nlohmann::json pairs = nlohmann::json::array();
  for (double above = 1; above * static_cast<double>(latency.count()) >= 1; above /= 1.7782794)
    pairs.push_back({above, latency.quantile_ns(1 - above) * 1e-3});
  return pairs;
}

/// Fraction of cycles that exceed a period, in s.
double above_period(const palpate::loop::LatencyHistogram& latency, double period) {
  const auto all = static_cast<double>(std::max<std::int64_t>(1, latency.count()));
  return static_cast<double>(latency.count_above(std::llround(period * 1e9))) / all;
}

nlohmann::json statistics(const Daemon& daemon) {
  const palpate::daemon::Counters& counters = daemon.counters();
  nlohmann::json json = {{"cycles", counters.cycles},
                         {"overruns", counters.overruns},
                         {"overrun_us", counters.overrun_ns / 1000},
                         {"shapes_not_converged", counters.shapes_not_converged},
                         {"page_faults", counters.page_faults},
                         {"allocations", counters.allocations},
                         {"gate_limited", counters.gate_limited},
                         {"gate_rejected", counters.gate_rejected},
                         {"commands_rejected", counters.commands_rejected}};
  for (int i = 0; i < palpate::daemon::kPhases; ++i) {
    const palpate::loop::LatencyHistogram& latency = counters.latency[i];
    json["latency_us"][name(static_cast<palpate::daemon::Phase>(i))] = {
        {"p50", latency.quantile_ns(0.5) * 1e-3},
        {"p99", latency.quantile_ns(0.99) * 1e-3},
        {"p99.9", latency.quantile_ns(0.999) * 1e-3},
        {"max", latency.max_ns() * 1e-3},
        {"above_period", above_period(latency, daemon.settings().loop.period)},
        {"tail", tail(latency)}};
  }
  for (int i = 0; i < daemon.inputs().channel_count(); ++i) {
    const palpate::daemon::InputReport report = daemon.inputs().report(i);
    json["inputs"][report.name] = {
        {"received", report.received}, {"lost", report.lost}, {"rejected", report.rejected}};
  }
  return json;
}

/// Lock-step repeats ticks, but not sensor messages.
void warn_of_losses(const Daemon& daemon) {
  for (int i = 0; i < daemon.inputs().channel_count(); ++i) {
    const palpate::daemon::InputReport report = daemon.inputs().report(i);
    if (report.lost > 0)
      spdlog::warn("{}: {} messages lost: another run with the same seed may differ", report.name,
                   report.lost);
  }
}

struct Options {
  std::string configuration;
  std::vector<std::string> overrides;
  std::string json;
  bool stepped = false;
  bool check = false;
};

void name_this_thread(const char* name) { pthread_setname_np(pthread_self(), name); }

/// Zero command.
void finish(Daemon& daemon) noexcept {
  daemon.finish({palpate::loop::monotonic_ns(), wall_clock_us(), 0});
}

/// The loop's thread never returns from a plug-in: the process ends without it.
void end_if_hung(const PluginWatchdog& watchdog) {
  if (watchdog.hung() == nullptr) return;
  spdlog::error("{} has not returned from a call in the loop: zero command, palpated ends",
                watchdog.hung());
  std::_Exit(end_log(palpate::config::kExitHung));
}

/// `has_plugins`: whether a watchdog is needed.
void run_real_time(Daemon& daemon, const sigset_t& signals, bool has_plugins) {
  constexpr std::int64_t kLongestRamp = 200'000'000;  // ns; the gate guarantees half of it
  std::atomic<bool> stop{false};
  std::atomic<std::int64_t> cycles{0};
  PluginWatchdog::Options options;
  options.enabled = has_plugins;
  if (daemon.settings().loop.fifo_priority > 0)
    options.fifo_priority = daemon.settings().loop.fifo_priority + 1;
  PluginWatchdog watchdog(options, cycles, [&daemon](const char*) { finish(daemon); });
  std::thread thread([&] {
    name_this_thread("palpated-loop");
    const auto watched = watchdog.watch_this_thread();
    palpate::loop::FixedRateLoop loop(daemon.settings().loop);
    const std::string refusals = loop.acquire_real_time();
    if (!refusals.empty()) spdlog::warn("real time: {}", refusals);
    std::atomic<bool> ended{false};
    std::int64_t stopped_ns = 0;
    loop.run(ended, [&](const palpate::loop::FixedRateLoop::Tick& tick) {
      if (stop && stopped_ns == 0) {
        stopped_ns = tick.now_ns;
        daemon.pipeline().stop();
      }
      daemon.tick({tick.now_ns, wall_clock_us(), tick.lateness_ns, tick.missed});
      ended = stopped_ns != 0 && (daemon.is_still() || tick.now_ns - stopped_ns > kLongestRamp);
      cycles.fetch_add(1, std::memory_order_relaxed);
    });
    finish(daemon);
  });
  wait_for_end(signals, daemon, watchdog, cycles);
  end_if_hung(watchdog);
  stop = true;
  thread.join();
}

void run_stepped(Daemon& daemon, palpate::daemon::SteppedClock& clock,
                 palpate::bus::MessageBus& control, const sigset_t& signals, bool has_plugins) {
  constexpr std::int64_t kLookAtStop = 50'000'000;  // ns
  std::atomic<bool> stop{false};
  std::atomic<std::int64_t> rounds{0};  // continues without ticks
  PluginWatchdog::Options options;
  options.enabled = has_plugins;
  options.patience = 1;  // a cycle may take longer than in real time
  PluginWatchdog watchdog(options, rounds, [&daemon](const char*) { finish(daemon); });
  std::thread thread([&] {
    name_this_thread("palpated-loop");
    const auto watched = watchdog.watch_this_thread();
    while (!stop) {
      if (control.receive(kLookAtStop)) clock.run_pending(daemon);
      rounds.fetch_add(1, std::memory_order_relaxed);
    }
  });
  wait_for_end(signals, daemon, watchdog, rounds);
  end_if_hung(watchdog);
  stop = true;
  thread.join();
}

std::string extent_of(const palpate::pipeline::Pipeline& pipeline) {
  if (!pipeline.has_object()) return "senses only, no object";
  const palpate::registry::Object& object = pipeline.object();
  return fmt::format("{} nodes, {} elements, {} grasped, {} fixed", object.body.mesh.node_count(),
                     object.body.mesh.element_count(),
                     object.body.grasps.empty() ? 0 : object.body.grasps[0].nodes.size(),
                     object.body.fixed_nodes.size());
}

/// Builds all that a start would build, except the network and the folder of records.
int check(const Options& options) {
  const auto root = palpate::config::Node::load_file(options.configuration, options.overrides);
  const auto bus = palpate::bus::make_memory_bus(palpate::bus::make_memory_hub());
  const Daemon daemon(root, *bus, *bus, Mode::kDeterministic, 1);
  for (const std::string& remark : daemon.pipeline().remarks()) spdlog::warn("{}", remark);
  spdlog::info("{}: valid configuration; {}", options.configuration, extent_of(daemon.pipeline()));
  return 0;
}

int run(const Options& options, const sigset_t& signals) {
  namespace bus = palpate::bus;
  const auto root = palpate::config::Node::load_file(options.configuration, options.overrides);
  const palpate::daemon::Settings settings = palpate::daemon::read_settings(root);
  const auto control = bus::make_lcm_bus(settings.control_url, settings.largest_message);
  const auto housekeeping = bus::make_lcm_bus(settings.housekeeping_url);
  const std::int64_t session = bus::random_session();
  Daemon daemon(root, *control, *housekeeping,
                options.stepped ? Mode::kDeterministic : Mode::kRealTime, session);
  // After the configuration has been read to its end: that is what is wrong first. Nothing has been
  // sent or received until here.
  const bus::InstanceLock lock(settings.control_url);
  palpate::daemon::SteppedClock clock(*control, session);
  control->set_receiver_priority(std::max(0, settings.loop.fifo_priority - 1));
  if (!options.stepped) {
    // queue for wrenches, contacts, estimate and feature of a hundred cycles, and half a second of
    // shapes
    control->start_publisher(500, 4096);
    housekeeping->start_publisher(64, bus::kLargestShortMessage);
  }
  // the housekeeping bus is not read
  options.stepped ? control->start_without_thread() : control->start();

  spdlog::info("palpated {}: {}; inactive{}", PALPATE_VERSION, extent_of(daemon.pipeline()),
               daemon.pipeline().has_object() ? ", waits for start" : "");
  for (const std::string& remark : daemon.pipeline().remarks()) spdlog::warn("{}", remark);
  const palpate::daemon::CrashHandler crash_handler(daemon.crash_record());
  const bool has_plugins = root.has("plugins");
  options.stepped ? run_stepped(daemon, clock, *control, signals, has_plugins)
                  : run_real_time(daemon, signals, has_plugins);
  write_record(daemon);
  control->stop();
  if (options.stepped) warn_of_losses(daemon);
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << statistics(daemon).dump(2) << '\n';
    if (!file) throw std::runtime_error(options.json + ": cannot be written");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpated feels the shape of a soft object through force and touch, and steers it.\n"
      "It reads sensors from the control URL and starts inactive with zero command; it moves the\n"
      "robot only after COMPONENT_COMMAND start and with a SHAPE_TARGET.\n"
      "With record.folder it writes its last seconds there as an LCM log when it faults, on "
      "SIGUSR1,\n"
      "and when it crashes. It answers systemd's Type=notify and WatchdogSec.");
  Options options;
  app.add_option("--config", options.configuration,
                 "configuration, YAML, see rt/config/examples; required");
  palpate::config::add_deprecated_positional(app, "configuration", options.configuration,
                                             "--config");
  app.add_option("--set", options.overrides,
                 "override a key: path.to.key=value (repeatable), e.g. "
                 "object.material.young_modulus=39e3; a value of ~ takes the key away")
      ->allow_extra_args(false);
  app.add_option("--json", options.json, "write statistics to this file at the end");
  app.add_flag("--check", options.check,
               "validate the configuration completely, without network or robot, and end");
  app.add_flag("--stepped", options.stepped,
               "run one cycle for each SIM_TICK (palpate-sim --fast) instead of in real time");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer(
      "Example:\n"
      "  palpated --config bar.yaml --check\n"
      "  palpated --config bar.yaml --set loop.fifo_priority=60 --json statistics.json");
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{0, "ended by a signal, or the configuration is valid (--check)"},
            {palpate::config::kExitHung,
             "a plug-in did not return from a call in the loop; the robot has been sent a zero "
             "command"},
            {78,
             "wrong configuration; the message names file, line, key, value and allowed range"}}}))
    return *code;
  if (options.configuration.empty())
    return palpate::config::usage_error(app, "--config is required");

  const sigset_t signals = block_signals();
  start_log();
  int code = 1;
  try {
    code = options.check ? check(options) : run(options, signals);
  } catch (const palpate::config::Error& error) {
    spdlog::error("{}", error.what());
    code = palpate::config::kExitCode;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  return end_log(code);
}
