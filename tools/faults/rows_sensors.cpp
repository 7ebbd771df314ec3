// Sensors that lie, stop, repeat themselves or start anew, and clocks that jump.

#include <cmath>

#include "tools/faults/rows.hpp"
#include "tools/faults/transforms.hpp"

namespace palpate::faults {
namespace {

constexpr double kMaxAge = 25;                // ms, by default, of what sensor models take
constexpr double kSeen = kMaxAge + 1 + 1e-6;  // ms
constexpr double kInf = std::numeric_limits<double>::infinity();

double period_of(const std::string& channel) {
  if (channel == "FT_WRENCH") return 1e-3;
  if (channel == "ROBOT_STATE") return 2e-3;
  return channel == "IMU" ? 1.0 / 300 : 1e-2;
}

/// When the channel's last message before `time` came, s.
double last_before(const Stream& stream, const std::string& channel, double time) {
  double last = 0;
  for (const bus::Published& message : stream) {
    const double t = 1e-9 * static_cast<double>(message.time_ns);
    if (message.channel == channel && t < time - 1e-9) last = t;
  }
  return last;
}

double draw_bad(math::Random& random) {
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(), kInf, -kInf, 1e308, -1e308};
  return kBad[random.below(5)];
}

RunResult run_bad_among_good(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "bad numbers");
  const Window window{0.25, 0.65};
  const Stream faulted = mutate(bench.recording.stream, sensors_in(window),
                                random.uniform(0.02, 0.5), draw_bad, random);
  const Trace trace = Replay(bench.recording).run(faulted, 850);
  const Window from{first_difference(faulted, bench.recording.stream), window.end};
  RunResult result = judge(trace, bench.reference, from, true);
  result.measured = trace.not_finite;
  return result;
}

RunResult run_denormal(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "denormal");
  const Window window{0.25, 0.65};
  // A quaternion stays one: of force-torque and inertial unit alone.
  const char* channel = random.below(2) == 0 ? "FT_WRENCH" : "IMU";
  const Stream faulted = mutate(
      bench.recording.stream, sensors_in(window, channel), random.uniform(0.02, 1),
      [](math::Random& r) { return std::ldexp(r.uniform(-1, 1), -1040); }, random);
  const Trace trace = Replay(bench.recording).run(faulted, 850);
  RunResult result = judge(trace, bench.reference, window, false);
  result.measured = trace.not_finite;
  return result;
}

/// Full scale of one number after another, as an overloaded converter gives it.
RunResult run_saturated(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "saturated");
  const Window window{0.25 + random.uniform(0, 0.05), 0.55};
  const bool inertial = random.below(2) == 0;
  const char* channel = inertial ? "IMU" : "FT_WRENCH";
  const int number = static_cast<int>(random.below(inertial ? 3 : 6));
  const double scale = (inertial ? 157 : number < 3 ? 660 : 60) * (random.below(2) ? 1 : -1);
  Stream faulted = bench.recording.stream;
  const Which which = sensors_in(window, channel);
  for (bus::Published& message : faulted)
    if (which(message)) put_number(message, number_offsets(message)[number], scale);
  constexpr int kTicks = 1700;
  const Trace trace = Replay(bench.recording).run(faulted, kTicks);
  RunResult result = judge(trace, bench.reference, window, true);
  const double zero = zero_after(trace, window.begin, window.end);
  result.measured = 1e3 * zero;
  if (zero < 0) result.fail("the command does not come to zero");
  int moves = static_cast<int>(window.end / kTick);
  while (moves < kTicks && !(trace.cycles[moves].speed > 1e-3)) ++moves;
  result.recovered = kTick * moves - window.end;
  if (moves == kTicks) result.note("stands still for another second and more");
  return result;
}

/// Detection, zero command and recovery of a sensor that says nothing of use within `window`.
RunResult judge_stop(const Bench& bench, const Stream& faulted, const Window& window,
                     const std::string& channel) {
  const Trace trace = Replay(bench.recording).run(faulted, 900);
  RunResult result = judge(trace, bench.reference, window, true);
  const double last = last_before(bench.recording.stream, channel, window.begin);
  if (result.detected >= 0) result.measured = 1e3 * (window.begin + result.detected - last);
  if (result.detected < 0) result.fail("not detected");
  const double zero = zero_after(trace, window.begin, window.end);
  if (zero < 0 || zero > kZeroWithin)
    result.fail("command zero after " + std::to_string(1e3 * zero) + " ms");
  const double recover_within = 5 * period_of(channel) + 5 * kTick;
  if (result.recovered < 0 || result.recovered > recover_within)
    result.note("recovers in " + std::to_string(1e3 * result.recovered) + " ms, not " +
                std::to_string(1e3 * recover_within));
  return result;
}

RunResult run_only_bad(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "only bad");
  constexpr const char* kChannels[] = {"FT_WRENCH", "IMU", "ROBOT_STATE"};
  const std::string channel = kChannels[random.below(3)];
  const Window window{0.25 + random.uniform(0, 0.1), 0.55};
  const Stream faulted =
      mutate(bench.recording.stream, sensors_in(window, channel), 1.0, draw_bad, random);
  return judge_stop(bench, faulted, window, channel);
}

Row stop_row(const std::string& channel, const std::string& name) {
  Row row{"5",  name + " stops", "seen within max_age + 1 T, zero in 100 ms, recovers",
          "ms", kSeen,           false,
          {}};
  row.run = [channel](const Bench& bench, std::uint64_t seed) {
    math::Random random(seed, "stop " + channel);
    const double begin = 0.25 + random.uniform(0, 0.1);
    const Window window{begin, begin + random.uniform(0.15, 0.3)};
    const Stream faulted = lose(bench.recording.stream, sensors_in(window, channel), 1.0, random);
    return judge_stop(bench, faulted, window, channel);
  };
  return row;
}

/// The hand says at 100 Hz whether it holds; a last word holds.
RunResult run_hand_stops(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "hand stops");
  const double begin = 0.25 + random.uniform(0, 0.1);
  const Window window{begin, begin + random.uniform(0.2, 0.4)};
  const Stream faulted =
      lose(bench.recording.stream, sensors_in(window, "HAND_STATE"), 1.0, random);
  const Trace trace = Replay(bench.recording).run(faulted, 850);
  RunResult result = judge(trace, bench.reference, window, false);
  result.measured = 1e3 * result.visible;
  if (result.visible < 0) result.fail("silent: neither HEALTH nor an event tells");
  return result;
}

RunResult run_target_stops(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "target stops");
  const int last = 250 + static_cast<int>(random.below(100));
  Replay replay(bench.recording);
  const Trace trace = replay.run(bench.recording.stream, 850, [&](int tick, daemon::Now&) {
    if (tick > kTargetTick && tick < last && tick % 50 == 0) replay.send_target(true);
    return true;
  });
  RunResult result = judge(trace, bench.reference, {1e-3 * last, 0.85}, false);
  result.measured = different_cycles(trace, bench.reference, true);
  return result;
}

Row frozen_row(const std::string& channel, const std::string& name) {
  Row row{"6", name + " repeats itself", "degraded within 1 s", "ms", 1000, false, {}};
  row.run = [channel](const Bench& bench, std::uint64_t seed) {
    math::Random random(seed, "frozen " + channel);
    const double begin = 0.25 + random.uniform(0, 0.1);
    const Window window{begin, begin + 1.0};
    const Stream faulted = freeze(bench.recording.stream, sensors_in(window, channel));
    const Trace trace = Replay(bench.recording).run(faulted, 1500);
    RunResult result = judge(trace, bench.reference, window, false);
    result.measured = 1e3 * result.detected;
    if (result.detected < 0) result.fail("not detected");
    return result;
  };
  return row;
}

/// Samples of the inertial unit until the contact wrench is again what it was without the jump.
double samples_to_lock(const Trace& trace, const Trace& reference, double jump, double next) {
  constexpr double kNoise = 0.025;  // N, N m
  double locked = jump;
  for (double t = jump; t < next; t += kTick) {
    const std::size_t i = static_cast<std::size_t>(std::lround(t / kTick)) - 1;
    if (i >= trace.cycles.size()) break;
    if ((trace.cycles[i].wrench - reference.cycles[i].wrench).lpNorm<Eigen::Infinity>() > kNoise)
      locked = t + kTick;
  }
  return (locked - jump) / period_of("IMU");
}

RunResult run_clock(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "clock");
  constexpr std::int64_t kSteps[] = {3'600'000'000, 1000, 1'000'000};  // us
  std::vector<std::pair<double, std::int64_t>> jumps;
  for (double t = 0.25 + random.uniform(0, 0.1); t < 0.9; t += random.uniform(0.2, 0.4))
    jumps.emplace_back(t, kSteps[random.below(3)] * (random.below(2) ? 1 : -1));
  const auto offset = [&jumps](std::int64_t time_ns) {
    std::int64_t sum = 0;
    for (const auto& [time, step] : jumps)
      if (1e-9 * static_cast<double>(time_ns) >= time) sum += step;
    return sum;
  };
  const bool ours = random.below(2) == 0;
  const bool theirs = !ours || random.below(2) == 0;
  const Stream faulted =
      theirs ? shift_clocks(bench.recording.stream, offset) : bench.recording.stream;
  constexpr int kTicks = 1200;
  Replay replay(bench.recording);
  const Trace trace = replay.run(faulted, kTicks, [&](int, daemon::Now& now) {
    if (ours) now.utime += offset(now.monotonic_ns);
    return true;
  });
  RunResult result = judge(trace, bench.reference, {jumps[0].first, 1e-3 * kTicks}, false);
  if (replay.daemon().counters().cycles != kTicks) result.fail("a cycle was missed");
  if (const int cycles = different_cycles(trace, bench.reference, false); cycles > 0)
    result.note("shape or commands differ in " + std::to_string(cycles) + " cycles");
  result.measured = 0;
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    const double next = i + 1 < jumps.size() ? jumps[i + 1].first : 1e-3 * kTicks;
    result.measured =
        std::max(result.measured, samples_to_lock(trace, bench.reference, jumps[i].first, next));
  }
  return result;
}

/// All senders end and begin anew: their clocks from zero, another session.
RunResult run_restart(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "restart");
  const double at = 0.25 + 1e-3 * static_cast<double>(random.below(100));
  const double pause = random.below(4) == 0 ? 0 : 1e-3 * static_cast<double>(random.below(400));
  const double again = at + pause + 0.3;
  const Stream faulted = restart(bench.recording.stream, at, pause, 77);
  Replay replay(bench.recording);
  const int start = static_cast<int>(std::lround(again / kTick));
  const Trace trace = replay.run(faulted, start + 300, [&](int tick, daemon::Now&) {
    if (tick == start) replay.user().send("start");
    return true;
  });
  RunResult result = judge(trace, bench.reference, {at, again}, true);
  const auto first = static_cast<std::size_t>(std::lround((at + pause) / kTick));
  std::size_t inactive = first;
  while (inactive < trace.cycles.size() && trace.cycles[inactive].command_valid) ++inactive;
  result.measured = 1e3 * kTick * static_cast<double>(inactive - first);
  for (std::size_t i = inactive; i + 1 < static_cast<std::size_t>(start); ++i)
    if (trace.cycles[i].command_valid) result.fail("a command before it was started again");
  if (trace.cycles.back().state != component::LifeCycle::kActive)
    result.note("is not active after it was started again");
  return result;
}

}  // namespace

std::vector<Row> sensor_rows() {
  return {
      {"4", "NaN, Inf, 1e308 among good", "0 not finite downstream", "", 0, false,
       run_bad_among_good},
      {"4", "NaN, Inf, 1e308 only", "stale within max_age + 1 T, zero in 100 ms", "ms", kSeen,
       false, run_only_bad},
      {"4", "denormal numbers", "0 not finite downstream", "", 0, false, run_denormal},
      {"4", "saturated sensor", "zero command in 100 ms", "ms", 100, false, run_saturated},
      stop_row("FT_WRENCH", "force-torque"),
      stop_row("ROBOT_STATE", "robot state"),
      stop_row("IMU", "inertial unit"),
      {"5", "hand's state stops", "in HEALTH 100 ms after the next message was due", "ms", 110.5,
       false, run_hand_stops},
      {"5", "target is repeated no more", "holds, to the bit", "cycles", 0, false,
       run_target_stops},
      frozen_row("FT_WRENCH", "force-torque"),
      frozen_row("ROBOT_STATE", "robot state"),
      frozen_row("IMU", "inertial unit"),
      {"7", "wall clocks jump", "0 cycles missed, locks in 50 samples", "samples", 50, false,
       run_clock},
      {"19", "simulator restarts", "inactive within 1 s, no command before start", "ms", 1000,
       false, run_restart},
  };
}

}  // namespace palpate::faults
