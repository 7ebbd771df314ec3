#pragma once

#include <string>

#include "tools/common/keyboard.hpp"

namespace palpate::top {

/// Keys that a terminal sends.
enum class Key { kNone, kQuit, kSort, kReset, kUp, kDown, kPageUp, kPageDown, kHome };

/// The terminal in full-screen mode: keys arrive immediately without echo, the cursor is hidden,
/// and the previous contents are restored at the end.
class Terminal {
 public:
  /// Throws std::runtime_error if standard input or output is not a terminal.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  struct Size {
    int columns = 80, rows = 24;
  };
  Size size() const noexcept;
  void draw(const std::string& bytes) const noexcept;
  /// Waits for a key, up to a time-out; kNone if there was none or the size has changed, kQuit also
  /// at the end of the input.
  Key wait(int timeout_ms);

 private:
  common::Keyboard keyboard_{false};  // a suspended program would leave the screen as it is
};

/// Whether the terminal has colours and the user enables them (NO_COLOR, TERM).
bool wants_colours();

}  // namespace palpate::top
