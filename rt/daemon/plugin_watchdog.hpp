#pragma once

#include <atomic>
#include <cstdint>
#include <ctime>
#include <functional>
#include <thread>

#include "rt/plugin/supervision.hpp"

namespace palpate::daemon {

/// Thread that notices a plug-in which does not return from a call in the loop. A loop thread that
/// merely waits for a processor, on a machine without real-time scheduling, does not count.
class PluginWatchdog {
 public:
  struct Options {
    double patience = 0.01;   // s without a cycle, all of them within a call of a plug-in
    double interval = 0.001;  // s between two looks
    int fifo_priority = 0;    // 0: ordinary scheduling
    bool enabled = true;      // false: no thread, and nothing is noticed
  };

  /// `cycles`: count of the loop. `act(component)` runs once, in the watchdog's thread, after the
  /// loop's thread has been stopped: it can do what that thread alone may do.
  PluginWatchdog(const Options& options, const std::atomic<std::int64_t>& cycles,
                 std::function<void(const char*)> act);
  ~PluginWatchdog();

  /// Call in the loop's thread before its first cycle. Keep the result while cycles run.
  plugin::RecordCalls watch_this_thread();

  /// Name of the component that did not return; nullptr: none. Set after `act` has returned.
  const char* hung() const noexcept { return hung_; }

 private:
  void run();
  bool is_runnable() const;
  std::int64_t processor_time_ns() const noexcept;

  Options options_;
  const std::atomic<std::int64_t>& cycles_;
  std::function<void(const char*)> act_;
  plugin::CallRecord calls_;
  // Of the loop's thread; 0: not known yet.
  std::atomic<int> thread_id_{0};
  std::atomic<clockid_t> clock_{0};
  std::atomic<const char*> hung_{nullptr};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate::daemon
