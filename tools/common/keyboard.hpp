#pragma once

#include <termios.h>

#include <cstdint>
#include <string>

namespace palpate::common {

/// Keys of the terminal as they are pressed, not echoed, where standard input is a terminal whose
/// foreground job this program is; otherwise no key ever comes.
class Keyboard {
 public:
  static constexpr const char* kEndOfInput = "\x04";

  /// `may_suspend`: the terminal's key for suspending the program keeps its effect.
  explicit Keyboard(bool may_suspend = true);
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_there() const noexcept { return is_there_; }
  /// A character, or the whole sequence of a key such as "\x1b[A"; empty where none came within the
  /// time, in nanoseconds, or a signal ended the wait; kEndOfInput where the input has ended.
  std::string wait(std::int64_t timeout_ns);

 private:
  bool is_there_ = false;
  termios before_{};
  std::string escape_;  // the sequence begun
};

}  // namespace palpate::common
