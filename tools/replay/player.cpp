#include "tools/replay/player.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::replay {
namespace {

constexpr double kLeastRate = 1e-3, kMostRate = 1e3;

[[noreturn]] void refuse(const std::string& option, double value, double duration) {
  throw std::invalid_argument(option + " " + std::to_string(value) + " s: the logs last " +
                              std::to_string(duration) + " s");
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

}  // namespace palpate::replay
