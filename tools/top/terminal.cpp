#include "tools/top/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace palpate::top {
namespace {

constexpr char kOpen[] = "\x1b[?1049h\x1b[?25l\x1b[2J";
constexpr char kClose[] = "\x1b[?25h\x1b[?1049l";

}  // namespace

Terminal::Terminal() {
  if (isatty(STDOUT_FILENO) == 0 || !keyboard_.is_there())
    throw std::runtime_error("this is no terminal; --once prints plain text, --json JSON");
  draw(kOpen);
  // Only to end the wait: the size is queried at each drawing.
  struct sigaction action {};
  action.sa_handler = [](int) {};
  sigaction(SIGWINCH, &action, nullptr);
}

Terminal::~Terminal() { draw(kClose); }

Terminal::Size Terminal::size() const noexcept {
  winsize given{};
  Size size;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &given) == 0 && given.ws_col > 0 && given.ws_row > 0)
    size = {given.ws_col, given.ws_row};
  return size;
}

void Terminal::draw(const std::string& bytes) const noexcept {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t wrote = write(STDOUT_FILENO, bytes.data() + done, bytes.size() - done);
    if (wrote < 0 && errno != EINTR) return;
    if (wrote > 0) done += static_cast<std::size_t>(wrote);
  }
}

Key Terminal::wait(int timeout_ms) {
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

bool wants_colours() {
  const char* none = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return (none == nullptr || *none == '\0') && term != nullptr && std::string(term) != "dumb";
}

}  // namespace palpate::top
