#include "tools/common/interruption.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace palpate::common {
namespace {

volatile std::sig_atomic_t raised = 0;

void raise_flag(int) { raised = 1; }

}  // namespace

void catch_interruptions() {
  struct sigaction action = {};
  action.sa_handler = raise_flag;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool is_interrupted() { return raised != 0; }

void throw_if_interrupted() {
  if (is_interrupted()) throw Interrupted();
}

void sleep_for(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    throw_if_interrupted();
    const std::chrono::duration<double> left = end - Clock::now();
    if (left.count() <= 0) return;
    std::this_thread::sleep_for(std::min(left, std::chrono::duration<double>(0.02)));
  }
}

}  // namespace palpate::common
