#pragma once

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <thread>

namespace palpate::daemon {

/// From now on spdlog writes from a thread of its own, and what finds its queue full goes: a disk
/// may be full and a journal may hang, but nobody here waits for them. Block signals before.
inline void start_log() {
  constexpr std::size_t kRoom = 1024;  // lines
  spdlog::init_thread_pool(kRoom, 1);
  spdlog::set_default_logger(
      spdlog::create_async_nb<spdlog::sinks::stdout_color_sink_mt>("palpated"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
}

/// Waits a little for the last lines to be written; where they cannot be, ends the process without
/// them. Otherwise returns the exit code.
inline int end_log(int exit_code) {
  auto written = std::make_shared<std::promise<void>>();
  auto future = written->get_future();
  std::thread([written] {
    spdlog::shutdown();
    written->set_value();
  }).detach();
  if (future.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready)
    _exit(exit_code);
  return exit_code;
}

}  // namespace palpate::daemon
