#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <string>

#include "rt/bus/log_ring.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::daemon {

/// Section `record` of the configuration.
struct RecordSettings {
  std::string folder;  // empty: recording is disabled
  double seconds = 2;
  int keep = 20;  // number of records kept in the folder; the oldest are deleted
};

/// Records the messages received and published on one bus during the last seconds, for a fault or a
/// crash. The loop's thread writes to memory without lock or allocation; another thread writes the
/// file, an LCM event log in which every message has the time of the cycle that received or
/// published it.
class CrashRecord final : public bus::MessageTap {
 public:
  /// Observes `bus`, which must outlive this object, and creates the folder. `period`: of the loop,
  /// s, determines the memory. Throws std::runtime_error if the folder cannot be created or
  /// written.
  CrashRecord(const RecordSettings& settings, double period, bus::MessageBus& bus);
  ~CrashRecord();
  CrashRecord(const CrashRecord&) = delete;
  CrashRecord& operator=(const CrashRecord&) = delete;

  /// Loop: call at the start of a cycle. The log's clock is the wall clock of the first cycle and
  /// then follows the monotonic clock.
  void begin_cycle(std::int64_t monotonic_ns, std::int64_t utime) noexcept;
  void note(const std::string& channel, const void* data, int size) noexcept override;
  /// Loop: hands over the recorded messages at the end of this cycle for writing; `cause`
  /// ("fault"), a string literal, becomes part of the file name. No effect while the previous
  /// record is still being written.
  void hand_over(const char* cause) noexcept { wanted_ = cause; }

  /// Any thread: requests a record without a fault.
  void request() noexcept { requested_.store(true, std::memory_order_relaxed); }

  /// Writing thread: returns the file written, empty if there was nothing to write. Throws
  /// std::runtime_error on failure, which is not retried.
  std::string write_handed_over();

  /// From the signal handler of a crash: stops recording and writes the available messages. -1:
  /// failure.
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
  const char* wanted_ = nullptr;  // cause of the requested record
  bool clock_set_ = false;
  std::int64_t clock_offset_us_ = 0;
  std::int64_t now_us_ = 0;
};

/// During its lifetime SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT write the record before they end
/// the process as usual. At most one instance.
class CrashHandler {
 public:
  /// nullptr: no effect.
  explicit CrashHandler(CrashRecord* record);
  ~CrashHandler();
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;
};

}  // namespace palpate::daemon
