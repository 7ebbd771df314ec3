#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <string>

#include "rt/bus/log_ring.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::daemon {

/// Section `record`.
struct RecordSettings {
  std::string folder;  // empty: nothing is recorded
  double seconds = 2;
  int keep = 20;  // records in the folder; the oldest go
};

/// What the daemon took and said on one bus in its last seconds, for when it faults or crashes. The
/// loop's thread writes it to memory without lock or allocation; another one writes the file, an
/// LCM event log, in which every message has the time of the cycle that took or published it.
class CrashRecord final : public bus::MessageTap {
 public:
  /// Taps `bus`, which must live longer, and makes the folder. `period`: of the loop, s, for the
  /// room that is taken. Throws std::runtime_error where the folder cannot be made or written.
  CrashRecord(const RecordSettings& settings, double period, bus::MessageBus& bus);
  ~CrashRecord();
  CrashRecord(const CrashRecord&) = delete;
  CrashRecord& operator=(const CrashRecord&) = delete;

  /// Loop: at the start of a cycle. The log's clock is the wall clock of the first one, then runs
  /// with the monotonic clock.
  void begin_cycle(std::int64_t monotonic_ns, std::int64_t utime) noexcept;
  void note(const std::string& channel, const void* data, int size) noexcept override;
  /// Loop: hands over what is there when this cycle is done, to be written; `cause` ("fault"), a
  /// string literal, is part of the file's name. Nothing where the last one is not written yet.
  void hand_over(const char* cause) noexcept { wanted_ = cause; }

  /// Any thread: a record is wanted without a fault.
  void request() noexcept { requested_.store(true, std::memory_order_relaxed); }

  /// Writing thread: the file that was written, empty where there was nothing to write. Throws
  /// std::runtime_error where it cannot be; then it is not tried again.
  std::string write_handed_over();

  /// From a signal handler of a crash: stops the recording and writes what there is. -1: failed.
  int write_in_crash() noexcept;
  const char* crash_path() const noexcept { return crash_path_.c_str(); }

 private:
  static constexpr int kNone = -1;
  void exchange_rings() noexcept;
  void remove_old_ones() const;

  RecordSettings settings_;
  std::filesystem::path folder_;
  std::string crash_path_;
  bus::MessageBus& bus_;
  std::array<bus::LogRing, 2> rings_;  // one being filled, one being written
  std::atomic<int> filled_{0};
  std::atomic<int> handed_over_{kNone};
  std::atomic<const char*> cause_{""};
  std::atomic<bool> requested_{false}, stopped_{false};
  const char* wanted_ = nullptr;  // why a record shall be handed over
  bool clock_set_ = false;
  std::int64_t clock_offset_us_ = 0;
  std::int64_t now_us_ = 0;
};

/// While it lives, SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT write the record before they end the
/// process as they would have. There can be one.
class CrashHandler {
 public:
  /// nullptr: does nothing.
  explicit CrashHandler(CrashRecord* record);
  ~CrashHandler();
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;
};

}  // namespace palpate::daemon
