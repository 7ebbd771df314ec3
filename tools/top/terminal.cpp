#include "tools/top/terminal.hpp"

#include <poll.h>
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
  if (isatty(STDOUT_FILENO) == 0 || tcgetattr(STDIN_FILENO, &before_) != 0)
    throw std::runtime_error("this is no terminal; --once prints plain text, --json JSON");
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  // A stopped process would leave the screen in this mode.
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  draw(kOpen);
  // Only to end the wait: the size is queried at each drawing.
  struct sigaction action {};
  action.sa_handler = [](int) {};
  sigaction(SIGWINCH, &action, nullptr);
}

Terminal::~Terminal() {
  draw(kClose);
  tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

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
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (poll(&watched, 1, timeout_ms) <= 0) {
    escape_.clear();
    return Key::kNone;
  }
  char c = 0;
  const ssize_t got = read(STDIN_FILENO, &c, 1);
  if (got < 0 && errno == EINTR) return Key::kNone;
  return got == 1 ? pressed(c) : Key::kQuit;
}

Key Terminal::pressed(char c) {
  if (!escape_.empty() || c == '\x1b') {
    escape_ += c;
    if (escape_ == "\x1b" || escape_ == "\x1b[" || escape_ == "\x1bO" || escape_ == "\x1b[5" ||
        escape_ == "\x1b[6")
      return Key::kNone;
    const std::string whole = std::move(escape_);
    escape_.clear();
    if (whole == "\x1b[A" || whole == "\x1bOA") return Key::kUp;
    if (whole == "\x1b[B" || whole == "\x1bOB") return Key::kDown;
    if (whole == "\x1b[5~") return Key::kPageUp;
    if (whole == "\x1b[6~") return Key::kPageDown;
    if (whole == "\x1b[H") return Key::kHome;
    return Key::kNone;
  }
  switch (c) {
    case 'q':
    case 'Q':
      return Key::kQuit;
    case 's':
      return Key::kSort;
    case 'r':
      return Key::kReset;
    case 'k':
      return Key::kUp;
    case 'j':
      return Key::kDown;
    case 'g':
      return Key::kHome;
    default:
      return Key::kNone;
  }
}

bool wants_colours() {
  const char* none = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return (none == nullptr || *none == '\0') && term != nullptr && std::string(term) != "dumb";
}

}  // namespace palpate::top
