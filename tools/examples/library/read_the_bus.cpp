// Reads the bus: prints the estimated wrench of the hand on the object and Young's modulus, once
// per second, until interrupted. Reception is palpate's own, which malformed datagrams cannot
// disturb.
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <palpate/channels.hpp>
#include <palpate/estimate_t.hpp>

#include "rt/bus/message_bus.hpp"

namespace {
volatile std::sig_atomic_t interrupted = 0;
}

int main(int argc, char** argv) try {
  using namespace palpate;
  const char* url = argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0";
  std::signal(SIGINT, [](int) { interrupted = 1; });

  const std::unique_ptr<bus::MessageBus> bus = bus::make_lcm_bus(url);
  bus::TypedSubscription<estimate_t> estimates(*bus, channel::kEstimate, 64);
  bus->start_without_thread();

  std::int64_t printed_us = 0;
  while (interrupted == 0) {
    bus->receive(100'000'000);  // ns
    estimate_t estimate;
    std::int64_t arrival_ns = 0;
    while (estimates.take(estimate, arrival_ns)) {
      if (estimate.utime - printed_us < 1'000'000) continue;
      printed_us = estimate.utime;
      const double* w = estimate.reaction[0];
      std::printf("status %d, hand applies %.2f %.2f %.2f N, E = %.1f kPa", estimate.status, w[0],
                  w[1], w[2], 1e-3 * std::exp(estimate.log_young_modulus));
      if (estimate.log_young_modulus_deviation >= 0)
        std::printf(" +- %.0f %%\n", 100 * estimate.log_young_modulus_deviation);
      else
        std::printf(" (configured)\n");
      std::fflush(stdout);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
