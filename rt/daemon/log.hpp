#pragma once

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <thread>

namespace palpate::daemon {

/// Makes spdlog write from a separate thread and drop lines if its queue is full, so that a full
/// disk or a blocked journal never delays the daemon. Block signals before this call.
inline void start_log() {
  constexpr std::size_t kRoom = 1024;  // lines
  spdlog::init_thread_pool(kRoom, 1);
  spdlog::set_default_logger(
      spdlog::create_async_nb<spdlog::sinks::stdout_color_sink_mt>("palpated"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
}

/// Waits briefly for the last lines to be written; if that fails, ends the process without them.
/// Otherwise returns the exit code.
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
