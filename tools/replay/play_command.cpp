#include "tools/replay/play_command.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <regex>
#include <stdexcept>

#include "rt/bus/message_bus.hpp"
#include "rt/config/command_line.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/common/keyboard.hpp"
#include "tools/record/listener.hpp"

namespace palpate::replay {
namespace {

constexpr double kLeastRate = 1e-3, kMostRate = 1e3;

[[noreturn]] void refuse(const std::string& option, double value, double duration) {
  throw std::invalid_argument(option + " " + std::to_string(value) + " s: the logs last " +
                              std::to_string(duration) + " s");
}

volatile std::sig_atomic_t stopped = 0;

bool matches(const std::string& channel, const char* pattern) {
  return std::regex_match(channel, std::regex(pattern));
}

/// Destination of the messages of each log.
class Outlets {
 public:
  explicit Outlets(const PlayCommand& command)
      : command_(command), filter_(command.channels, command.invert) {
    std::vector<record::Source> sources = record::default_sources();
    record::put_urls(command.urls, sources);
    for (const std::string& log : command.logs) {
      std::string file;
      const std::string label = label_of(log, file);
      const auto source = std::find_if(sources.begin(), sources.end(),
                                       [&](const auto& one) { return one.label == label; });
      if (source == sources.end())
        throw std::invalid_argument(log + ": no URL has the label " + label + "; give --url " +
                                    label + "=udpm://...");
      files_.push_back(file);
      auto& bus = buses_[source->url.text()];
      if (!bus) bus = bus::make_lcm_bus(source->url.text());
      outlets_.push_back(bus.get());
      if (!command.quiet)
        std::printf("%s to %s %s\n", file.c_str(), label.c_str(), source->url.text().c_str());
    }
    std::fflush(stdout);
  }

  const std::vector<std::string>& files() const { return files_; }
  long sent() const { return sent_; }
  long left_out() const { return left_out_; }
  long refused() const { return refused_; }

  void take(int log, const bus::LoggedEvent& event) {
    if (!wants(event.channel)) {
      ++left_out_;
    } else if (outlets_[static_cast<std::size_t>(log)]->publish(event.channel.c_str(), event.data,
                                                                event.size)) {
      ++sent_;
    } else {
      ++refused_;
    }
  }

 private:
  bool wants(const std::string& channel) {
    const auto known = wanted_.find(channel);
    if (known != wanted_.end()) return known->second;
    const bool wanted = filter_.wants(channel) && (command_.commands || !is_command(channel)) &&
                        (!command_.inputs_only || is_input(channel));
    return wanted_[channel] = wanted;
  }

  const PlayCommand& command_;
  record::ChannelFilter filter_;
  std::map<std::string, bool> wanted_;
  std::map<std::string, std::unique_ptr<bus::MessageBus>> buses_;  // by URL
  std::vector<bus::MessageBus*> outlets_;                          // by log
  std::vector<std::string> files_;
  long sent_ = 0, left_out_ = 0, refused_ = 0;
};

void obey(const std::string& key, Player& player, std::int64_t now_ns, const Sink& sink) {
  constexpr double kJump = 5;  // s
  if (key == "q" || key == common::Keyboard::kEndOfInput) stopped = 1;
  if (key == " ") player.pause(!player.paused(), now_ns);
  if (key == ".") player.step(now_ns, sink);
  if (key == "+") player.set_rate(2 * player.rate(), now_ns);
  if (key == "-") player.set_rate(0.5 * player.rate(), now_ns);
  if (key == "\x1b[D") player.seek(player.position(now_ns) - kJump, now_ns);
  if (key == "\x1b[C") player.seek(player.position(now_ns) + kJump, now_ns);
}

void show(const Player& player, std::int64_t now_ns) {
  std::fprintf(stderr, "\r%8.1f of %.1f s, %g x%s, %lld messages \x1b[K", player.position(now_ns),
               player.duration(), player.rate(), player.paused() ? ", paused" : "",
               static_cast<long long>(player.played()));
}

}  // namespace

Player::Player(const std::vector<std::string>& logs, const PlayerOptions& options)
    : rate_(std::clamp(options.rate, kLeastRate, kMostRate)), loop_(options.loop) {
  first_us_ = std::numeric_limits<std::int64_t>::max();
  last_us_ = std::numeric_limits<std::int64_t>::min();
  for (const std::string& path : logs) {
    logs_.push_back(std::make_unique<Log>(path));
    bus::EventLogReader& reader = logs_.back()->reader;
    while (const bus::LoggedEvent* event = reader.next()) {
      first_us_ = std::min(first_us_, event->utime);
      last_us_ = std::max(last_us_, event->utime);
    }
    if (!reader.complaint().empty()) complaints_.push_back(reader.complaint());
  }
  if (first_us_ > last_us_) throw std::runtime_error("no message in " + logs.front());
  const double end = options.end < 0 ? duration() : options.end;
  if (options.start < 0 || options.start > duration()) refuse("--start", options.start, duration());
  if (end < options.start) refuse("--end", end, duration());
  start_us_ = first_us_ + std::llround(1e6 * options.start);
  end_us_ = std::min<std::int64_t>(last_us_, first_us_ + std::llround(1e6 * end));
  rewind_to(start_us_, -1);
}

std::vector<std::string> Player::complaints() const { return complaints_; }

std::int64_t Player::position_us(std::int64_t now_ns) const {
  if (base_ns_ < 0 || paused_) return base_us_;
  const double passed = 1e-3 * static_cast<double>(now_ns - base_ns_) * rate_;
  return std::min(end_us_, base_us_ + static_cast<std::int64_t>(passed));
}

double Player::position(std::int64_t now_ns) const {
  return 1e-6 * static_cast<double>(position_us(now_ns) - first_us_);
}

Player::Log* Player::earliest() const {
  Log* earliest = nullptr;
  for (const auto& log : logs_) {
    if (log->next == nullptr) continue;
    if (earliest == nullptr || log->next->utime < earliest->next->utime) earliest = log.get();
  }
  return earliest != nullptr && earliest->next->utime <= end_us_ ? earliest : nullptr;
}

void Player::rewind_to(std::int64_t us, std::int64_t now_ns) {
  for (const auto& log : logs_) {
    log->reader.rewind();
    do {
      log->next = log->reader.next();
    } while (log->next != nullptr && log->next->utime < us);
  }
  base_us_ = us;
  base_ns_ = now_ns;
}

void Player::play(Log& log, const Sink& sink) {
  const auto at = std::find_if(logs_.begin(), logs_.end(),
                               [&log](const auto& one) { return one.get() == &log; });
  sink(static_cast<int>(at - logs_.begin()), *log.next);
  ++played_;
  log.next = log.reader.next();
}

std::int64_t Player::advance(std::int64_t now_ns, const Sink& sink) {
  constexpr std::int64_t kLongest = 1'000'000'000;  // ns: upper bound of the wait
  if (base_ns_ < 0) base_ns_ = now_ns;
  if (paused_) return kLongest;
  const std::int64_t until = position_us(now_ns);
  Log* log = earliest();
  for (; log != nullptr && log->next->utime <= until; log = earliest()) play(*log, sink);
  if (log == nullptr) {
    if (!loop_) return -1;
    rewind_to(start_us_, now_ns);
    return 0;
  }
  const double wait = 1e3 * static_cast<double>(log->next->utime - until) / rate_;
  return static_cast<std::int64_t>(std::min(wait, static_cast<double>(kLongest)));
}

void Player::set_rate(double rate, std::int64_t now_ns) {
  base_us_ = position_us(now_ns);
  base_ns_ = now_ns;
  rate_ = std::clamp(rate, kLeastRate, kMostRate);
}

void Player::pause(bool paused, std::int64_t now_ns) {
  base_us_ = position_us(now_ns);
  base_ns_ = now_ns;
  paused_ = paused;
}

void Player::seek(double seconds, std::int64_t now_ns) {
  const std::int64_t us = first_us_ + std::llround(1e6 * seconds);
  rewind_to(std::clamp(us, start_us_, end_us_), now_ns);
}

void Player::step(std::int64_t now_ns, const Sink& sink) {
  Log* log = earliest();
  if (!paused_ || log == nullptr) return;
  base_us_ = std::max(base_us_, log->next->utime);
  base_ns_ = now_ns;
  play(*log, sink);
}

bool is_command(const std::string& channel) {
  return matches(channel,
                 "(TWIST_COMMAND|JOINT_VELOCITY_COMMAND|HAND_COMMAND|COMPONENT_COMMAND|"
                 "SHAPE_TARGET|MANUAL_FORCE|TOUCH_REQUEST)(_[0-9]+)?");
}

bool is_input(const std::string& channel) {
  return matches(
      channel,
      "(FT_WRENCH|IMU|ROBOT_STATE|HAND_STATE)(_[0-9]+)?|(BIOTAC|FINGERTIP)_[0-9]|SHAPE_OBSERVATION|"
      "SHAPE_TARGET|MANUAL_FORCE|COMPONENT_COMMAND|TOUCH_REQUEST");
}

std::string label_of(const std::string& log, std::string& file) {
  const std::size_t equals = log.find('=');
  if (equals != std::string::npos && log.find('/') > equals) {
    file = log.substr(equals + 1);
    return log.substr(0, equals);
  }
  file = log;
  const std::string name = std::filesystem::path(log).filename().string();
  for (const char* label : {"control", "housekeeping", "pictures"}) {
    if (name.find(std::string(".") + label + ".") != std::string::npos) return label;
  }
  return "control";
}

void PlayCommand::add_to(CLI::App& app) {
  app.add_option("logs", logs,
                 "logs that were recorded together. NAME.LABEL.lcmlog, as palpate-record writes "
                 "them, goes to the URL of its label; LABEL=FILE says it; else control")
      ->required();
  record::add_url_option(app, urls);
  app.add_option("--start", player.start, "s since the first message, where to begin")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--end", player.end, "s, where to stop")->check(CLI::NonNegativeNumber);
  app.add_option("--rate", player.rate, "times as fast as recorded")
      ->check(CLI::Range(1e-3, 1e3))
      ->capture_default_str();
  app.add_flag("--loop", player.loop, "from --start again at the end");
  app.add_option("-c,--channel", channels, "regular expression that a channel's whole name matches")
      ->capture_default_str();
  app.add_flag("-v,--invert-channels", invert, "the channels that do not match instead");
  app.add_flag("--inputs", inputs_only, "only what palpated listens to, for one that runs");
  app.add_flag(
      "--commands", commands,
      "also what moves a robot or a hand (TWIST_COMMAND, JOINT_VELOCITY_COMMAND, "
      "HAND_COMMAND), or makes a palpated that runs do so (COMPONENT_COMMAND, SHAPE_TARGET, "
      "MANUAL_FORCE, TOUCH_REQUEST), which is left out otherwise");
  app.add_flag("-q,--quiet", quiet, "no progress and no summary");
  app.footer(
      "Keys, on a terminal: space pauses, . plays one message, + and - change the rate, left and\n"
      "right arrow jump by 5 s, q quits.\n"
      "Examples:\n"
      "  palpate-replay play run.control.lcmlog run.housekeeping.lcmlog --rate 0.5\n"
      "  palpate-replay play run.control.lcmlog --inputs --start 12 --end 20 --loop");
}

int PlayCommand::run() const {
  struct sigaction action {};
  action.sa_handler = [](int) { stopped = 1; };
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  Outlets outlets(*this);
  Player player_(outlets.files(), player);
  for (const std::string& complaint : player_.complaints())
    std::fprintf(stderr, "warning: %s\n", complaint.c_str());
  const Sink sink = [&](int log, const bus::LoggedEvent& event) { outlets.take(log, event); };
  common::Keyboard keyboard;
  const bool shows = !quiet && isatty(STDERR_FILENO) != 0;
  std::int64_t shown_ns = 0;
  while (stopped == 0) {
    const std::int64_t wait_ns = player_.advance(loop::monotonic_ns(), sink);
    if (wait_ns < 0) break;
    obey(keyboard.wait(std::min<std::int64_t>(wait_ns, 100'000'000)), player_, loop::monotonic_ns(),
         sink);
    const std::int64_t now_ns = loop::monotonic_ns();
    if (shows && now_ns - shown_ns > 200'000'000) {
      shown_ns = now_ns;
      show(player_, now_ns);
    }
  }
  if (shows) std::fprintf(stderr, "\n");
  if (!quiet)
    std::printf("%ld messages sent, %ld left out, %ld too large for a datagram or refused\n",
                outlets.sent(), outlets.left_out(), outlets.refused());
  return stopped == 0 ? config::kExitDone : config::kExitInterrupted;
}

}  // namespace palpate::replay
