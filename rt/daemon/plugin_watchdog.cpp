#include "rt/daemon/plugin_watchdog.hpp"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <string>

#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::daemon {
namespace {

/// A thread that has run for less of the time without a cycle than this share waits for a processor
/// if it is runnable.
constexpr double kLeastShare = 0.5;

}  // namespace

PluginWatchdog::PluginWatchdog(const Options& options, const std::atomic<std::int64_t>& cycles,
                               std::function<void(const char*)> act)
    : options_(options), cycles_(cycles), act_(std::move(act)) {
  if (options.enabled) thread_ = loop::start_helper_thread("palpated-watch", [this] { run(); });
}

PluginWatchdog::~PluginWatchdog() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

plugin::RecordCalls PluginWatchdog::watch_this_thread() {
  clockid_t clock = 0;
  if (pthread_getcpuclockid(pthread_self(), &clock) == 0) clock_ = clock;
  thread_id_ = gettid();
  return plugin::RecordCalls(calls_);
}

/// Whether the loop's thread executes code or could, as opposed to being asleep.
bool PluginWatchdog::is_runnable() const {
  std::ifstream file("/proc/self/task/" + std::to_string(thread_id_) + "/stat");
  std::string line;
  std::getline(file, line);
  const auto end = line.rfind(") ");  // of the thread's name
  return end != std::string::npos && end + 2 < line.size() && line[end + 2] == 'R';
}

std::int64_t PluginWatchdog::processor_time_ns() const noexcept {
  timespec time{};
  if (thread_id_ == 0 || clock_gettime(clock_, &time) != 0) return 0;
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

void PluginWatchdog::run() {
  if (options_.fifo_priority > 0) loop::take_fifo(options_.fifo_priority);
  const auto patience_ns = static_cast<std::int64_t>(options_.patience * 1e9);
  std::int64_t cycles = -1, moved_ns = 0, ran_ns = 0;
  const char* component = nullptr;
  while (!stop_) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.interval));
    const std::int64_t now_ns = loop::monotonic_ns();
    const char* current = calls_.component();
    if (cycles_ != cycles || current != component || current == nullptr) {
      cycles = cycles_;
      component = current;
      moved_ns = now_ns;
      ran_ns = processor_time_ns();
      continue;
    }
    if (now_ns - moved_ns < patience_ns) continue;
    const auto ran = static_cast<double>(processor_time_ns() - ran_ns);
    if (is_runnable() && ran < kLeastShare * static_cast<double>(patience_ns)) continue;
    if (!calls_.claim(component)) continue;
    act_(component);
    hung_ = component;
    return;
  }
}

}  // namespace palpate::daemon
