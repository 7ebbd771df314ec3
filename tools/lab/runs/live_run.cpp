#include "tools/lab/runs/live_run.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <palpate/channels.hpp>
#include <sstream>
#include <utility>

#include "rt/bus/text.hpp"
#include "rt/bus/udpm_url.hpp"
#include "tools/common/interruption.hpp"

namespace palpate::runs {
namespace {

// s; the simulator settles the plant under gravity first
constexpr double kActivationPatience = 30;
constexpr const char* kReady = "waits for start";  // output of palpated once it is subscribed
constexpr double kSlice = 0.1;                     // s
constexpr double kDrain = 0.1;                     // s, between two checks of the logs
constexpr double kLoggersPatience = 30;            // s, to write pending data
constexpr const char* kEndOfLog = "END_OF_LOG";    // channel of the mark at the end of a log
constexpr int kTail = 15;                          // lines of a failed program's output

std::vector<std::string> with_settings(std::vector<std::string> command,
                                       const std::vector<std::string>& overrides,
                                       const Urls& urls) {
  const auto set = [&command](const std::string& setting) {
    command.push_back("--set");
    command.push_back(setting);
  };
  for (const std::string& setting : overrides) set(setting);
  set("bus.control=" + urls.control);
  set("bus.housekeeping=" + urls.housekeeping);
  return command;
}

std::vector<std::string> source_command(const RunPlan& plan, const RunFiles& files,
                                        const Urls& urls) {
  const Source& source = plan.source;
  if (!source.log.empty())
    return {"lcm-logplayer", "--lcm-url=" + urls.control, source.log.string()};
  std::vector<std::string> command{(common::program_folder() / "palpate-sim").string(),
                                   source.scene.string(), "--json", files.simulator.string()};
  if (source.duration > 0) {
    command.push_back("--duration");
    command.push_back(std::to_string(source.duration));
  }
  if (plan.lock_step) command.push_back("--fast");
  std::vector<std::string> overrides = source.scene_overrides;
  overrides.push_back("bus.pictures=" + urls.pictures);
  return with_settings(command, overrides, urls);
}

/// Whether one of its last messages is the end mark.
bool has_ended(const std::filesystem::path& log) {
  constexpr std::streamoff kLastBytes = 4096;
  std::ifstream file(log, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kLastBytes));
  std::stringstream tail;
  tail << file.rdbuf();
  return tail.str().find(kEndOfLog) != std::string::npos;
}

}  // namespace

Urls private_urls() {
  const auto url = [] { return bus::private_url().text(); };
  return {url(), url(), url()};
}

std::vector<shape_target_t> messages_of(const ControlTarget& target) {
  std::vector<double> points;
  for (const Eigen::Vector3d& point : target.rest_points)
    points.insert(points.end(), point.begin(), point.end());
  return client::make_target(target.kind, points, {target.values.begin(), target.values.end()});
}

LiveRun::LiveRun(const RunPlan& plan, const std::filesystem::path& folder)
    : plan_(plan),
      files_{folder / "control.log", folder / "housekeeping.log", folder / "simulator.json",
             folder / "palpated.json"},
      commands_(*control_, channel::kTwistCommand, 200) {
  if (plan.lock_step && (!plan.source.log.empty() || !(plan.source.duration > 0)))
    throw std::invalid_argument("a lock-step run wants a simulator that ends by itself");
  std::filesystem::create_directories(folder);
  const Urls& urls = urls_;
  spin(0);  // from now on messages are received
  const std::string palpated = (common::program_folder() / "palpated").string();
  // Not lcm-logger: a run in lock-step is faster than it can write, and it drops the excess.
  const std::string recorder = (common::program_folder() / "palpate-record").string();
  const auto record = [&](const std::string& label, const std::string& url,
                          const std::filesystem::path& log) {
    const std::string name = "logger_" + label;
    constexpr char kRoom[] =
        "&recv_buf_size=67108864";  // allows for a second in which other processes compute
    loggers_.emplace_back(
        name,
        std::vector<std::string>{recorder, "--quiet", "--force", "--flush-interval", "20", "--only",
                                 label, "--url", label + "=" + url + kRoom, log.string()},
        folder / (name + ".txt"));
  };
  if (plan.recorded) {
    record("control", urls.control, files_.control);
    record("housekeeping", urls.housekeeping, files_.housekeeping);
  }
  std::vector<std::string> command{palpated, "--config", plan.configuration.string(), "--json",
                                   files_.daemon.string()};
  if (plan.lock_step) command.push_back("--stepped");
  daemon_ = std::make_unique<common::Process>(
      "palpated", with_settings(command, plan.overrides, urls), folder / "palpated.txt");
  if (plan.lock_step) start_lock_step();
  // A recording does not wait: the daemon must be active before the first message is played.
  if (!plan.source.log.empty()) activate();
  source_ =
      std::make_unique<common::Process>(plan.source.log.empty() ? "palpate-sim" : "lcm-logplayer",
                                        source_command(plan, files_, urls), folder / "source.txt");
  if (plan.source.log.empty() && !plan.lock_step) activate();
}

void LiveRun::fail(const std::string& what, const common::Process* at_fault) const {
  std::string text = what;
  if (at_fault != nullptr) {
    const std::string words = common::tail(at_fault->output(), kTail);
    text += "; " + at_fault->output().string() + (words.empty() ? " is empty" : ":\n" + words);
  }
  throw RunFailed(text);
}

std::string LiveRun::reason() const {
  return client_.health() ? bus::get_text(client_.health()->reason) : "no HEALTH was received";
}

bool LiveRun::check_programs() {
  const auto check = [this](common::Process& process) {
    if (const auto code = process.wait(0))
      fail(process.name() + " ended with exit code " + std::to_string(*code), &process);
  };
  for (common::Process& logger : loggers_) check(logger);
  check(*daemon_);
  if (!source_) return true;
  const auto code = source_->wait(0);
  if (code && *code != 0)
    fail(source_->name() + " ended with exit code " + std::to_string(*code), source_.get());
  return !code;
}

void LiveRun::set_target(const ControlTarget& target) {
  client_.set_target(messages_of(target), bus::wall_clock_us());
  still_since_ = 0;
}

void LiveRun::spin(double seconds) {
  client_.wait(seconds, [this] {
    common::throw_if_interrupted();
    watch_commands();
    return false;
  });
}

void LiveRun::watch_commands() {
  std::int64_t arrival_ns = 0;
  for (twist_command_t command; commands_.take(command, arrival_ns);) {
    const bool moving =
        std::any_of(command.twist, command.twist + 6, [](double v) { return std::abs(v) > 1e-6; });
    if (moving || !client_.target_error())
      still_since_ = 0;
    else if (still_since_ == 0)
      still_since_ = bus::wall_clock_us();
  }
}

/// s for which the daemon has followed our target and commanded no motion.
double LiveRun::settled() const {
  if (still_since_ == 0) return 0;
  return static_cast<double>(bus::wall_clock_us() - still_since_) * 1e-6;
}

void LiveRun::start_lock_step() {
  const std::int64_t begin = bus::wall_clock_us();
  const double patience = std::max(kActivationPatience, plan_.standstill);
  while (common::tail(daemon_->output(), kTail).find(kReady) == std::string::npos) {
    check_programs();
    if (static_cast<double>(bus::wall_clock_us() - begin) * 1e-6 > patience)
      fail("palpated does not listen", daemon_.get());
    spin(0.02);
  }
  client_.send({"start"}, bus::wall_clock_us());
  if (plan_.target) set_target(*plan_.target);
  spin(0.1);
}

void LiveRun::complete_lock_step(common::Progress& progress) {
  // Slowness is not a failure: the duration of a run depends on the machine, its result does not.
  std::int64_t simulated = 0, since = bus::wall_clock_us();  // us
  while (check_programs()) {
    const std::int64_t now = client_.health() ? client_.health()->utime : 0;
    if (now != simulated) since = bus::wall_clock_us();
    simulated = now;
    if (static_cast<double>(bus::wall_clock_us() - since) * 1e-6 > plan_.standstill)
      fail("the simulation stands still", source_.get());
    if (!client_.refusal().empty()) fail("palpated refused: " + client_.refusal(), daemon_.get());
    progress.show(static_cast<double>(simulated) * 1e-6 / plan_.source.duration);
    spin(kSlice);
  }
  if (!client_.is_running()) fail("palpated was not active at the end", daemon_.get());
}

void LiveRun::activate() {
  const std::int64_t begin = bus::wall_clock_us();
  std::int64_t sent = 0;
  while (!client_.is_running()) {
    const std::int64_t now = bus::wall_clock_us();
    if (static_cast<double>(now - begin) * 1e-6 > kActivationPatience) {
      fail("palpated did not become active: " + reason() +
               (client_.refusal().empty() ? "" : "; refused: " + client_.refusal()),
           daemon_.get());
    }
    if (!check_programs()) fail(source_->name() + " ended at once", source_.get());
    const bool ready = client_.health() && (!source_ || client_.received(channel::kRobotState) > 0);
    if (ready && now - sent > 500000) {
      client_.send({"start"}, now);
      sent = now;
    }
    spin(0.05);
  }
}

void LiveRun::complete(common::Progress& progress) {
  if (plan_.lock_step) return complete_lock_step(progress);
  if (plan_.target) set_target(*plan_.target);
  const std::int64_t begin = bus::wall_clock_us();
  for (;;) {
    const double elapsed = static_cast<double>(bus::wall_clock_us() - begin) * 1e-6;
    if (elapsed >= plan_.duration || !check_programs()) return;
    std::string note;
    if (plan_.target) {
      if (!client_.refusal().empty())
        fail("palpated refused the target: " + client_.refusal(), nullptr);
      if (client_.is_active() && settled() >= plan_.settled) return;
      if (const auto error = client_.target_error())
        note = std::to_string(*error * 1e3).substr(0, 5) + " mm";
    }
    progress.show(elapsed / plan_.duration, note);
    spin(std::min(kSlice, plan_.duration - elapsed));
  }
}

/// A logger writes in the order of arrival: messages sent before a mark found in its log are in it
/// as well, if they arrived at all.
void LiveRun::await_loggers() {
  if (!plan_.recorded) return;
  for (const auto& [url, log] : {std::pair{urls_.control, files_.control},
                                 std::pair{urls_.housekeeping, files_.housekeeping}}) {
    const auto marker = bus::make_lcm_bus(url);
    const std::int64_t begin = bus::wall_clock_us();
    while (!has_ended(log)) {
      if (static_cast<double>(bus::wall_clock_us() - begin) * 1e-6 > kLoggersPatience)
        fail("the logger does not write " + log.string(), nullptr);
      marker->publish(kEndOfLog, kEndOfLog, 1);
      spin(kDrain);
    }
  }
}

RunFiles LiveRun::finish() {
  const bool healthy = client_.health() && client_.health()->state != health_t::STATE_FAULTED;
  const std::string why = reason();
  const auto stop = [this](common::Process& process, bool may_have_ended) {
    const bool ended = !process.running();
    const int code = process.stop();
    if (code != 0 || (ended && !may_have_ended))
      fail(process.name() +
               (ended ? " ended by itself with exit code " : " ended with exit code ") +
               std::to_string(code),
           &process);
  };
  stop(*source_, true);
  stop(*daemon_, false);
  await_loggers();
  for (common::Process& logger : loggers_) logger.stop();
  if (!healthy) fail("palpated ended faulted: " + why, daemon_.get());
  return files_;
}

RunFiles run_live(const RunPlan& plan, const std::filesystem::path& folder,
                  common::Progress& progress) {
  LiveRun run(plan, folder);
  run.complete(progress);
  return run.finish();
}

}  // namespace palpate::runs
