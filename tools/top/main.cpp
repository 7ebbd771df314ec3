#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "rt/config/command_line.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/keyboard.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/top/view.hpp"

// palpate-top: shows traffic on palpate's LCM URLs, in a terminal. See --help.

namespace palpate::top {
namespace {

constexpr char kOpen[] = "\x1b[?1049h\x1b[?25l\x1b[2J";
constexpr char kClose[] = "\x1b[?25h\x1b[?1049l";

/// Keys that a terminal sends.
enum class Key { kNone, kQuit, kSort, kReset, kUp, kDown, kPageUp, kPageDown, kHome };

/// The terminal in full-screen mode: keys arrive immediately without echo, the cursor is hidden,
/// and the previous contents are restored at the end.
class Terminal {
 public:
  /// Throws std::runtime_error if standard input or output is not a terminal.
  Terminal() {
    if (isatty(STDOUT_FILENO) == 0 || !keyboard_.is_there())
      throw std::runtime_error("this is no terminal; --once prints plain text, --json JSON");
    draw(kOpen);
    // Only to end the wait: the size is queried at each drawing.
    struct sigaction action {};
    action.sa_handler = [](int) {};
    sigaction(SIGWINCH, &action, nullptr);
  }

  ~Terminal() { draw(kClose); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  struct Size {
    int columns = 80, rows = 24;
  };
  Size size() const noexcept {
    winsize given{};
    Size size;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &given) == 0 && given.ws_col > 0 && given.ws_row > 0)
      size = {given.ws_col, given.ws_row};
    return size;
  }

  void draw(const std::string& bytes) const noexcept {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t wrote = write(STDOUT_FILENO, bytes.data() + done, bytes.size() - done);
      if (wrote < 0 && errno != EINTR) return;
      if (wrote > 0) done += static_cast<std::size_t>(wrote);
    }
  }

  /// Waits for a key, up to a time-out; kNone if there was none or the size has changed, kQuit also
  /// at the end of the input.
  Key wait(int timeout_ms) {
    const std::string key = keyboard_.wait(std::int64_t{timeout_ms} * 1'000'000);
    if (key == common::Keyboard::kEndOfInput || key == "q" || key == "Q") return Key::kQuit;
    if (key == "s") return Key::kSort;
    if (key == "r") return Key::kReset;
    if (key == "k" || key == "\x1b[A" || key == "\x1bOA") return Key::kUp;
    if (key == "j" || key == "\x1b[B" || key == "\x1bOB") return Key::kDown;
    if (key == "\x1b[5~") return Key::kPageUp;
    if (key == "\x1b[6~") return Key::kPageDown;
    if (key == "g" || key == "\x1b[H") return Key::kHome;
    return Key::kNone;
  }

 private:
  common::Keyboard keyboard_{false};  // a suspended program would leave the screen as it is
};

/// Whether the terminal has colours and the user enables them (NO_COLOR, TERM).
bool wants_colours() {
  const char* none = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return (none == nullptr || *none == '\0') && term != nullptr && std::string(term) != "dumb";
}

}  // namespace
}  // namespace palpate::top

namespace {

using namespace palpate;

struct Options {
  std::vector<std::string> urls, shown;
  std::vector<std::filesystem::path> types;
  std::string json;
  bool once = false, plain = false;
  double seconds = 3;
  double interval = 0.25;  // s, between two drawings
};

constexpr char kHelp[] =
    "palpate-top shows what goes over palpate's LCM URLs: the daemon's state, cycle times by "
    "phase,\n"
    "overruns, faults and inputs as HEALTH reports them, and of every channel the rate, jitter\n"
    "(standard deviation and longest interval, ms), age, latency (from the sender's clock, ms),\n"
    "losses (gaps in the numbers), bandwidth, and its type, where it is one of palpate's or of\n"
    "--types. Latency and losses are known of palpate's types only.\n"
    "It only listens, through palpate's guarded receiver: no packet can end it.\n"
    "Keys: q quit, s sort by another column, r reset, arrows, j, k and page keys scroll.";
constexpr char kExamples[] =
    "Examples:\n"
    "  palpate-top\n"
    "  palpate-top --once --seconds 5 > now.txt\n"
    "  palpate-top --json -                        JSON on standard output\n"
    "  palpate-top --types drake/lcmtypes --show IIWA_STATUS\n"
    "                                              the values of a message of any LCM type\n"
    "  palpate-top --url control=udpm://239.255.76.67:7700?ttl=0\n"
    "Colours are left out with --plain, NO_COLOR set, or TERM=dumb.";

/// Data shared by the receiver and the display.
class Everything {
 public:
  Everything(const types::TypeSet& types, const std::vector<std::string>& shown)
      : channels_(types), shows_(!shown.empty()), values_(types, shown) {}
  void take(const record::Heard& heard) {
    const std::lock_guard<std::mutex> lock(mutex_);
    channels_.take(heard);
    daemon_.take(heard);
    if (shows_)
      values_.take(heard.source, heard.channel, heard.data, heard.size, heard.arrival_ns / 1000);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    channels_.clear();
    values_.clear();
  }
  /// Calls `use` with the current data.
  template <class Use>
  auto look(const record::Listener& listener, top::Order order, Use use) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::int64_t now_ns = loop::monotonic_ns();
    return use(top::View{&listener, listener.sources(), channels_.rows(now_ns, order), &daemon_,
                         now_ns, values_.shown(kMostValues)});
  }

 private:
  static constexpr std::size_t kMostValues = 10'000;  // of a message

  std::mutex mutex_;
  top::ChannelTable channels_;
  top::DaemonWatch daemon_;
  bool shows_;
  types::MessageValues values_;
};

void sleep_until_stopped(double seconds) {
  const std::int64_t end = loop::monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
  while (!common::is_interrupted() && loop::monotonic_ns() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

int print_once(Everything& everything, const record::Listener& listener, const Options& options) {
  sleep_until_stopped(options.seconds);
  return everything.look(listener, top::Order::kName, [&](const top::View& view) {
    if (options.once) {
      for (const top::Line& line : top::lines_of(view)) std::cout << line.text << '\n';
    }
    if (!options.json.empty()) common::write_json(top::json_of(view), options.json);
    return view.rows.empty() ? palpate::config::kExitUnavailable : 0;
  });
}

int show(Everything& everything, const record::Listener& listener, const Options& options) {
  top::Terminal terminal;
  const bool colours = !options.plain && top::wants_colours();
  top::Order order = top::Order::kName;
  int first = 0;
  while (!common::is_interrupted()) {
    const top::Terminal::Size size = terminal.size();
    const std::vector<top::Line> lines =
        everything.look(listener, order, [](const top::View& view) { return top::lines_of(view); });
    const int page = std::max(1, size.rows - 2);
    first = std::clamp(first, 0, std::max(0, static_cast<int>(lines.size()) - page));
    terminal.draw(top::frame(
        lines, size.columns, size.rows, first, colours,
        std::string("q quit  s sort (") + top::name(order) + ")  r reset  arrows scroll"));
    switch (terminal.wait(static_cast<int>(options.interval * 1e3))) {
      case top::Key::kNone:
        break;
      case top::Key::kQuit:
        return 0;
      case top::Key::kSort:
        order = top::next(order);
        break;
      case top::Key::kReset:
        everything.clear();
        break;
      case top::Key::kUp:
        --first;
        break;
      case top::Key::kDown:
        ++first;
        break;
      case top::Key::kPageUp:
        first -= page;
        break;
      case top::Key::kPageDown:
        first += page;
        break;
      case top::Key::kHome:
        first = 0;
        break;
    }
  }
  return 0;
}

int run(const Options& options) {
  std::vector<record::Source> sources = record::default_sources();
  record::put_urls(options.urls, sources);
  Everything everything(types::TypeSet(options.types), options.shown);
  record::Listener listener(
      sources, [&](const record::Heard& heard) { everything.take(heard); },
      record::kLargestMessage);
  listener.start();
  const bool prints = options.once || !options.json.empty();
  const int code =
      prints ? print_once(everything, listener, options) : show(everything, listener, options);
  listener.stop();
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kHelp);
  Options options;
  record::add_url_option(app, options.urls);
  types::add_types_option(app, options.types);
  app.add_option("--show", options.shown,
                 "show the values of this channel's last message too (repeatable)")
      ->type_name("CHANNEL")
      ->allow_extra_args(false);
  app.add_flag("--once", options.once, "print plain text once and end");
  app.add_option("--json", options.json,
                 "write JSON to this file, or - for standard output, and end")
      ->expected(0, 1)
      ->default_str("-");
  app.add_option("--seconds", options.seconds, "that --once and --json listen")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--interval", options.interval, "s, between two drawings")
      ->check(CLI::Range(0.02, 60.0))
      ->capture_default_str();
  app.add_flag("--plain", options.plain, "no colours");
  app.footer(kExamples);
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{palpate::config::kExitUnavailable, "nothing was heard (--once, --json)"}}}))
    return *code;
  if (app.count("--json") > 0 && options.json.empty()) options.json = "-";

  common::catch_interruptions();
  return common::run_program("error", [&] { return run(options); });
}
