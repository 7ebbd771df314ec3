#pragma once

#include <exception>

namespace palpate::common {

/// Ctrl-C or SIGTERM: unwinds the stack, so that destructors stop every child.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag.
void catch_interruptions();

bool is_interrupted();

/// Throws Interrupted once the flag is set.
void throw_if_interrupted();

/// Sleeps in short intervals; throws Interrupted.
void sleep_for(double seconds);

}  // namespace palpate::common
