#include "tools/common/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <ctime>
#include <utility>

namespace palpate::common {
namespace {

/// "ESC [" or "ESC O", then digits and semicolons, then a last character.
bool is_whole(const std::string& sequence) {
  if (sequence.size() < 3) return false;
  const auto last = static_cast<unsigned char>(sequence.back());
  return std::isdigit(last) == 0 && last != ';';
}

}  // namespace

Keyboard::Keyboard(bool may_suspend) {
  // A job in the background must not take the keys of the terminal.
  is_there_ = tcgetattr(STDIN_FILENO, &before_) == 0 && tcgetpgrp(STDIN_FILENO) == getpgrp();
  if (!is_there_) return;
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  if (!may_suspend) raw.c_cc[VSUSP] = _POSIX_VDISABLE;
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keyboard::~Keyboard() {
  if (is_there_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::string Keyboard::wait(std::int64_t timeout_ns) {
  const timespec timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  const int ready = ppoll(is_there_ ? &watched : nullptr, is_there_ ? 1 : 0, &timeout, nullptr);
  if (ready == 0) escape_.clear();  // it was the escape key itself
  if (ready <= 0) return "";
  char c = 0;
  const ssize_t got = read(STDIN_FILENO, &c, 1);
  if (got < 0) return errno == EINTR ? "" : kEndOfInput;
  if (got == 0) return kEndOfInput;
  if (escape_.empty() && c != '\x1b') return {c};
  escape_ += c;
  return is_whole(escape_) ? std::exchange(escape_, "") : "";
}

}  // namespace palpate::common
