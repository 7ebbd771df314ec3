// Cost of a datagram for the receiver's thread, by its defect: one iteration, one datagram,
// generated beforehand. And the cost of three messages per cycle for the publishing loop, sent
// directly or handed over; without subscribers.

#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>
#include <palpate/estimate_t.hpp>
#include <stdexcept>
#include <thread>

#include "rt/bus/lcm_bus.hpp"
#include "rt/bus/message_bus.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate::inject {
namespace {

constexpr int kDrawn = 256;

void handle(benchmark::State& state, std::vector<Kind> kinds) {
  bus::DatagramCounters counters;
  bus::UdpmReceiver receiver(counters);
  for (const Target& target : usual_targets())
    receiver.subscribe(target.channel, target.encoded_size, target.fingerprint, 64);
  PacketSource source(1, std::move(kinds), usual_targets());
  std::vector<std::vector<std::uint8_t>> datagrams;
  for (int i = 0; i < kDrawn; ++i) datagrams.push_back(source.next());
  std::size_t next = 0;
  for (auto _ : state) {
    const auto& datagram = datagrams[next++ % kDrawn];
    receiver.handle(datagram.data(), static_cast<int>(datagram.size()), 1);
  }
  state.SetItemsProcessed(state.iterations());
}

void publish(benchmark::State& state, bus::Urgency urgency) {
  std::unique_ptr<bus::MessageBus> bus;
  try {
    bus = bus::make_lcm_bus("udpm://239.255.76.41:47641?ttl=0");
    bus->start_publisher(300, 4096);
  } catch (const std::runtime_error& error) {
    state.SkipWithError(error.what());
    return;
  }
  bus::TypedPublisher<estimate_t> publisher(*bus, "ESTIMATE", urgency);
  const estimate_t message{};
  for (auto _ : state) {
    for (int i = 0; i < 3; ++i) publisher.publish(message);
    state.PauseTiming();
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    state.ResumeTiming();
  }
  state.counters["lost"] = static_cast<double>(bus->unpublished());
}

const int registered = [] {
  for (int i = 0; i < kKinds; ++i) {
    const auto kind = static_cast<Kind>(i);
    benchmark::RegisterBenchmark((std::string("handle/") + name(kind)).c_str(),
                                 [kind](benchmark::State& state) { handle(state, {kind}); });
  }
  benchmark::RegisterBenchmark("handle/all_malformed",
                               [](benchmark::State& state) { handle(state, malformed_kinds()); });
  benchmark::RegisterBenchmark("publish/now", [](benchmark::State& state) {
    publish(state, bus::Urgency::kNow);
  })->UseRealTime();
  benchmark::RegisterBenchmark("publish/later", [](benchmark::State& state) {
    publish(state, bus::Urgency::kLater);
  })->UseRealTime();
  return 0;
}();

}  // namespace
}  // namespace palpate::inject

BENCHMARK_MAIN();
