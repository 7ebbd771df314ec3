#pragma once

#include <termios.h>

#include <string>

namespace palpate::replay {

/// Action requested by a key.
enum class Wish { kNone, kPause, kStep, kFaster, kSlower, kBack, kForward, kQuit };

/// The terminal's keys as they are pressed, if standard input is a terminal; otherwise none.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_there() const noexcept { return is_there_; }
  /// Waits for a key, up to a time-out.
  Wish wait(std::int64_t timeout_ns);

 private:
  Wish wish_of(char c);

  bool is_there_ = false;
  termios before_{};
  std::string escape_;  // begun
};

}  // namespace palpate::replay
