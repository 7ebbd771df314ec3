// What a datagram costs the receiver's thread, by what is wrong with it: one iteration, one
// datagram, drawn beforehand.

#include <benchmark/benchmark.h>

#include "rt/bus/udpm_receiver.hpp"
#include "tools/inject/packets.hpp"

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

const int registered = [] {
  for (int i = 0; i < kKinds; ++i) {
    const auto kind = static_cast<Kind>(i);
    benchmark::RegisterBenchmark((std::string("handle/") + name(kind)).c_str(),
                                 [kind](benchmark::State& state) { handle(state, {kind}); });
  }
  benchmark::RegisterBenchmark("handle/all_malformed",
                               [](benchmark::State& state) { handle(state, malformed_kinds()); });
  return 0;
}();

}  // namespace
}  // namespace palpate::inject

BENCHMARK_MAIN();
