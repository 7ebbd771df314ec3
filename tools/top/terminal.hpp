#pragma once

#include <string>

#include "tools/common/keyboard.hpp"

namespace palpate::top {

/// Keys that a terminal sends.
enum class Key { kNone, kQuit, kSort, kReset, kUp, kDown, kPageUp, kPageDown, kHome };

/// The terminal as a screen to draw upon: keys come at once and unseen, the cursor is hidden, and
/// what was there before comes back at the end.
class Terminal {
 public:
  /// Throws std::runtime_error where standard input or output is none.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  struct Size {
    int columns = 80, rows = 24;
  };
  Size size() const noexcept;
  void draw(const std::string& bytes) const noexcept;
  /// Waits for a key, at most so long; kNone where none came or the size has changed, kQuit at the
  /// end of the input as well.
  Key wait(int timeout_ms);

 private:
  common::Keyboard keyboard_{false};  // a suspended program would leave the screen as it is
};

/// Whether the terminal has colours and the user wants them (NO_COLOR, TERM).
bool wants_colours();

}  // namespace palpate::top
