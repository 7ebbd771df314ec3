#include "tools/replay/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

#include <ctime>

namespace palpate::replay {

Keyboard::Keyboard() {
  // A background process must not read the terminal's keys.
  is_there_ = tcgetattr(STDIN_FILENO, &before_) == 0 && tcgetpgrp(STDIN_FILENO) == getpgrp();
  if (!is_there_) return;
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keyboard::~Keyboard() {
  if (is_there_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

Wish Keyboard::wait(std::int64_t timeout_ns) {
  const timespec timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (ppoll(is_there_ ? &watched : nullptr, is_there_ ? 1 : 0, &timeout, nullptr) <= 0)
    return Wish::kNone;
  char c = 0;
  const ssize_t got = read(STDIN_FILENO, &c, 1);
  return got == 1 ? wish_of(c) : got == 0 ? Wish::kQuit : Wish::kNone;
}

Wish Keyboard::wish_of(char c) {
  if (!escape_.empty() || c == '\x1b') {
    escape_ += c;
    if (escape_.size() < 3) return Wish::kNone;
    const std::string whole = std::move(escape_);
    escape_.clear();
    if (whole == "\x1b[C") return Wish::kForward;
    if (whole == "\x1b[D") return Wish::kBack;
    return Wish::kNone;
  }
  switch (c) {
    case ' ':
      return Wish::kPause;
    case '.':
      return Wish::kStep;
    case '+':
      return Wish::kFaster;
    case '-':
      return Wish::kSlower;
    case 'q':
      return Wish::kQuit;
    default:
      return Wish::kNone;
  }
}

}  // namespace palpate::replay
