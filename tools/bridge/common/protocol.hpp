#pragma once

#include <cstdint>
#include <string>

#include "tools/driver/arm.hpp"

namespace palpate::bridge {

using driver::Joints;

/// What one status of an arm says.
struct Reading {
  std::int64_t utime = 0;        // us, of the sender; not positive: unknown
  std::int64_t arrival_ns = 0;   // CLOCK_MONOTONIC, or virtual
  Joints q, dq, tau;             // rad, rad/s, N m
  const char* halted = nullptr;  // why the arm does not obey commands; nullptr: it does
};

/// Messages between the driver of one kind of arm and this program.
class Protocol {
 public:
  virtual ~Protocol() = default;

  /// Receives what has arrived, without waiting: once per cycle, before take().
  virtual void receive() = 0;
  /// The next status; false if there is none. Numbers may be non-finite.
  virtual bool take(Reading& reading) = 0;
  /// A complaint about what the driver has sent, once for each kind; empty if there is none.
  virtual std::string complaint() = 0;
  /// Whether another program has commanded the arm since the last call.
  virtual bool foreign_command() = 0;

  /// The arm stands at `q`, and motion begins there.
  virtual void begin(const Joints& q) = 0;
  /// Motion at `dq` for `dt`, s, which send() takes into account.
  virtual void advance(const Joints& dq, double dt) = 0;
  /// Publishes a command; `dq`: present velocity. `utime`: us, wall clock.
  virtual void send(const Joints& dq, std::int64_t utime) = 0;
  /// Whether the arm at `q` executes what has been sent.
  virtual bool follows(const Joints& q) const = 0;
  /// Whether an arm that reports no state any more is to be sent zero: by position commands it
  /// holds without, and a driver that starts again accepts none.
  virtual bool is_stopped_by_command() const = 0;
};

/// Readings of a wrist sensor that arrive separately from the states of the arm.
class WrenchInput {
 public:
  virtual ~WrenchInput() = default;
  /// The next reading, of the sensor on the hand, in S; false if there is none. All are finite.
  virtual bool take(math::Wrench& wrench_S) = 0;
};

}  // namespace palpate::bridge
