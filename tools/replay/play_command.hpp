#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::replay {

/// Receives a message of log number `log`.
using Sink = std::function<void(int log, const bus::LoggedEvent& event)>;

struct PlayerOptions {
  double start = 0;   // s of the logs, where to begin
  double end = -1;    // s, where to stop; negative: at their end
  double rate = 1;    // factor on the recorded speed
  bool loop = false;  // restart from start
};

/// Plays logs that were recorded together, message by message in the order of their times, paced by
/// a clock. Times are s since the first message of all. The caller provides the clock.
class Player {
 public:
  /// Reads the logs once for their length. Throws std::runtime_error naming the file for one that
  /// cannot be read or if none holds a message, and std::invalid_argument for options out of range.
  Player(const std::vector<std::string>& logs, const PlayerOptions& options);

  /// Passes on all messages due at `now_ns`, and returns the time until the next message, in ns;
  /// negative at the end (never with looping).
  std::int64_t advance(std::int64_t now_ns, const Sink& sink);

  double position(std::int64_t now_ns) const;
  double duration() const noexcept { return 1e-6 * static_cast<double>(last_us_ - first_us_); }
  double rate() const noexcept { return rate_; }
  bool paused() const noexcept { return paused_; }
  std::int64_t played() const noexcept { return played_; }

  void set_rate(double rate, std::int64_t now_ns);  // clamped to 1/1000 and 1000
  void pause(bool paused, std::int64_t now_ns);
  /// Seeks by this many s, within start and end; messages in between are not played.
  void seek(double seconds, std::int64_t now_ns);
  /// While paused: plays only the next message.
  void step(std::int64_t now_ns, const Sink& sink);

  /// Damaged parts of the logs, one line each.
  std::vector<std::string> complaints() const;

 private:
  struct Log {
    explicit Log(const std::string& path) : reader(path) {}
    bus::EventLogReader reader;
    const bus::LoggedEvent* next = nullptr;
  };
  std::int64_t position_us(std::int64_t now_ns) const;
  Log* earliest() const;
  void rewind_to(std::int64_t us, std::int64_t now_ns);
  void play(Log& log, const Sink& sink);

  std::vector<std::unique_ptr<Log>> logs_;
  std::vector<std::string> complaints_;
  double rate_ = 1;
  bool loop_ = false, paused_ = false;
  std::int64_t first_us_ = 0, last_us_ = 0;  // of all messages
  std::int64_t start_us_ = 0, end_us_ = 0;   // that are played
  std::int64_t base_us_ = 0,
               base_ns_ = -1;  // time of the logs at the start of the clock; -1: not started
  std::int64_t played_ = 0;
};

/// The command line of `palpate-replay play`.
struct PlayCommand {
  std::vector<std::string> logs;  // FILE or LABEL=FILE
  std::vector<std::string> urls;  // [LABEL=]URL
  PlayerOptions player;
  std::string channels = ".*";
  bool invert = false;
  bool inputs_only = false;  // the inputs of palpated
  bool commands = false;     // also what is_command()
  bool quiet = false;

  void add_to(CLI::App& app);
  /// Plays until the end, a signal, or the key q. Returns the exit code; throws std::runtime_error
  /// and std::invalid_argument.
  int run() const;
};

/// Whether a channel's messages move a robot or a hand, or command a running palpated, which then
/// moves them.
bool is_command(const std::string& channel);
/// Whether palpated receives it on its control URL.
bool is_input(const std::string& channel);
/// From "LABEL=FILE", or from a name given by palpate-record (run.housekeeping.lcmlog); control if
/// neither names it.
std::string label_of(const std::string& log, std::string& file);

}  // namespace palpate::replay
