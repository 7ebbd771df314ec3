// Sensors that send wrong values, stop, repeat themselves or restart, and clocks that jump.

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>

#include "tools/lab/faults/rows.hpp"
#include "tools/lab/faults/scenario.hpp"

namespace palpate::faults {
namespace {

/// ms, within which a silent sensor must be detected: by default the sensor model's time-out plus
/// one cycle.
double seen_within(const std::string& channel) {
  return (channel == channel::kImu ? 27 : 25) + 1 + 1e-6;
}

double period_of(const std::string& channel) {
  if (channel == channel::kFtWrench) return 1e-3;
  if (channel == channel::kRobotState) return 2e-3;
  return channel == channel::kImu ? 1.0 / 300 : 1e-2;
}

/// Arrival of the channel's last message before `time`, s.
double last_before(const Stream& stream, const std::string& channel, double time) {
  double last = 0;
  for (const bus::Published& message : stream) {
    const double t = 1e-9 * static_cast<double>(message.time_ns);
    if (message.channel == channel && t < time - 1e-9) last = t;
  }
  return last;
}

Scenario bad_among_good(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "bad numbers");
  const Window window{0.25, 0.65};
  Scenario scenario;
  scenario.stream = mutate(bench.recording.stream, sensors_in(window), random.uniform(0.02, 0.5),
                           bad_number, random);
  scenario.window = from_first(scenario.stream, bench, window);
  scenario.ticks = 850;
  return scenario;
}

Scenario denormal(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "denormal");
  Scenario scenario;
  scenario.window = {0.25, 0.65};
  // A unit quaternion remains one: only for the force-torque and inertial sensors.
  scenario.channel = random.below(2) == 0 ? channel::kFtWrench : channel::kImu;
  scenario.stream = mutate(
      bench.recording.stream, sensors_in(scenario.window, scenario.channel),
      random.uniform(0.02, 1), [](math::Random& r) { return std::ldexp(r.uniform(-1, 1), -1040); },
      random);
  scenario.ticks = 850;
  scenario.must_show = false;
  return scenario;
}

RunResult judge_numbers(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, scenario.must_show);
  result.measured = trace.not_finite;
  return result;
}

/// Full scale on one value after another, as an overloaded converter outputs it.
Scenario saturated(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "saturated");
  Scenario scenario;
  scenario.window = {0.25 + random.uniform(0, 0.05), 0.55};
  const bool inertial = random.below(2) == 0;
  scenario.channel = inertial ? channel::kImu : channel::kFtWrench;
  const int number = static_cast<int>(random.below(inertial ? 3 : 6));
  const double scale = (inertial ? 157 : number < 3 ? 660 : 60) * (random.below(2) ? 1 : -1);
  scenario.stream = bench.recording.stream;
  const Which which = sensors_in(scenario.window, scenario.channel);
  for (bus::Published& message : scenario.stream)
    if (which(message)) put_number(message, number_offsets(message)[number], scale);
  scenario.ticks = 1700;
  return scenario;
}

RunResult judge_saturated(const Bench& bench, const Scenario& scenario) {
  const Window& window = scenario.window;
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, window, true);
  const double zero = zero_after(trace, window.begin, window.end);
  result.measured = 1e3 * zero;
  if (zero < 0) result.fail("the command does not come to zero");
  int moves = static_cast<int>(window.end / kTick);
  while (moves < scenario.ticks && !(trace.cycles[moves].speed > 1e-3)) ++moves;
  result.recovered = kTick * moves - window.end;
  if (moves == scenario.ticks) result.note("stands still for another second and more");
  return result;
}

/// Detection, zero command and recovery for a sensor without usable output within `window`.
RunResult judge_stop(const Bench& bench, const Scenario& scenario) {
  const Window& window = scenario.window;
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, window, true);
  const double last = last_before(bench.recording.stream, scenario.channel, window.begin);
  if (result.detected >= 0) result.measured = 1e3 * (window.begin + result.detected - last);
  if (result.detected < 0) result.fail("not detected");
  const double zero = zero_after(trace, window.begin, window.end);
  if (zero < 0 || zero > kZeroWithin)
    result.fail("command zero after " + std::to_string(1e3 * zero) + " ms");
  const double recover_within = 5 * period_of(scenario.channel) + 5 * kTick;
  if (result.recovered < 0 || result.recovered > recover_within)
    result.note("recovers in " + std::to_string(1e3 * result.recovered) + " ms, not " +
                std::to_string(1e3 * recover_within));
  return result;
}

Scenario only_bad(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "only bad");
  constexpr const char* kChannels[] = {channel::kFtWrench, channel::kImu, channel::kRobotState};
  Scenario scenario;
  scenario.channel = kChannels[random.below(3)];
  scenario.window = {0.25 + random.uniform(0, 0.1), 0.55};
  scenario.stream = mutate(bench.recording.stream, sensors_in(scenario.window, scenario.channel),
                           1.0, bad_number, random);
  scenario.ticks = 900;
  return scenario;
}

/// `channel` is silent for `shortest` to `longest` s.
Scenario silence(const Bench& bench, const std::string& channel, double shortest, double longest,
                 math::Random random) {
  const double begin = 0.25 + random.uniform(0, 0.1);
  Scenario scenario;
  scenario.channel = channel;
  scenario.window = {begin, begin + random.uniform(shortest, longest)};
  scenario.stream = lose(bench.recording.stream, sensors_in(scenario.window, channel), 1.0, random);
  scenario.ticks = 900;
  return scenario;
}

Row stop_row(const std::string& channel, const std::string& name) {
  return scenario_row(
      {"5",
       name + " stops",
       "seen within max_age + 1 T, zero in 100 ms, recovers",
       "ms",
       seen_within(channel),
       false,
       {}},
      [channel](const Bench& bench, std::uint64_t seed) {
        return silence(bench, channel, 0.15, 0.3, math::Random(seed, "stop " + channel));
      },
      judge_stop);
}

/// The hand reports its grasp at 100 Hz; the last report remains valid.
Scenario hand_stops(const Bench& bench, std::uint64_t seed) {
  Scenario scenario =
      silence(bench, channel::kHandState, 0.2, 0.4, math::Random(seed, "hand stops"));
  scenario.must_show = false;
  return scenario;
}

RunResult judge_hand_stops(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, false);
  result.measured = 1e3 * result.visible;
  if (result.visible < 0) result.fail("silent: neither HEALTH nor an event reports it");
  return result;
}

Scenario target_stops(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "target stops");
  const int last = 250 + static_cast<int>(random.below(100));
  Scenario scenario;
  scenario.stream = bench.recording.stream;
  scenario.window = {1e-3 * last, 0.85};
  scenario.ticks = 850;
  scenario.must_show = false;
  for (int tick = 100; tick < last; tick += 50)
    scenario.acts.push_back({tick, [](client::Client& user) { user.repeat_target(0); }});
  return scenario;
}

RunResult judge_target_stops(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, false);
  result.measured = different_cycles(trace, bench.reference, true);
  return result;
}

Row frozen_row(const std::string& channel, const std::string& name) {
  return scenario_row(
      {"6", name + " repeats itself", "degraded within 1 s", "ms", 1000, false, {}},
      [channel](const Bench& bench, std::uint64_t seed) {
        math::Random random(seed, "frozen " + channel);
        const double begin = 0.25 + random.uniform(0, 0.1);
        Scenario scenario;
        scenario.channel = channel;
        scenario.window = {begin, begin + 1.0};
        scenario.stream = freeze(bench.recording.stream, sensors_in(scenario.window, channel));
        scenario.ticks = 1500;
        scenario.must_show = false;  // at once: it needs some time to take effect
        return scenario;
      },
      [](const Bench& bench, const Scenario& scenario) {
        const Trace trace = play(bench, scenario);
        RunResult result = judge(trace, bench.reference, scenario.window, false);
        result.measured = 1e3 * result.detected;
        if (result.detected < 0) result.fail("not detected");
        return result;
      });
}

/// Samples of the inertial unit until the contact wrench equals that of the run without the jump.
double samples_to_lock(const Trace& trace, const Trace& reference, double jump, double next) {
  constexpr double kNoise = 0.025;  // N, N m
  double locked = jump;
  for (double t = jump; t < next; t += kTick) {
    const std::size_t i = static_cast<std::size_t>(std::lround(t / kTick)) - 1;
    if (i >= trace.cycles.size()) break;
    if ((trace.cycles[i].wrench - reference.cycles[i].wrench).lpNorm<Eigen::Infinity>() > kNoise)
      locked = t + kTick;
  }
  return (locked - jump) / period_of(channel::kImu);
}

struct ClockJumps {
  std::vector<std::pair<double, std::int64_t>> jumps;  // s, us
  std::int64_t offset(std::int64_t time_ns) const {
    std::int64_t sum = 0;
    for (const auto& [time, step] : jumps)
      if (1e-9 * static_cast<double>(time_ns) >= time) sum += step;
    return sum;
  }
};

ClockJumps draw_jumps(math::Random& random) {
  constexpr std::int64_t kSteps[] = {3'600'000'000, 1000, 1'000'000};  // us
  ClockJumps jumps;
  for (double t = 0.25 + random.uniform(0, 0.1); t < 0.9; t += random.uniform(0.2, 0.4))
    jumps.jumps.emplace_back(t, kSteps[random.below(3)] * (random.below(2) ? 1 : -1));
  return jumps;
}

Scenario clock_scenario(const Bench& bench, const ClockJumps& jumps, bool ours, bool theirs) {
  const auto offset = [jumps](std::int64_t time_ns) { return jumps.offset(time_ns); };
  Scenario scenario;
  scenario.ticks = 1200;
  scenario.window = {jumps.jumps[0].first, 1e-3 * scenario.ticks};
  scenario.must_show = false;
  scenario.stream = theirs ? shift_clocks(bench.recording.stream, offset) : bench.recording.stream;
  if (ours) scenario.clock_offset = offset;
  return scenario;
}

/// Of the senders: the clock of a machine shared with others must not be set.
Scenario senders_clocks(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "clock");
  return clock_scenario(bench, draw_jumps(random), false, true);
}

RunResult run_clock(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "clock");
  const ClockJumps clock = draw_jumps(random);
  const auto& jumps = clock.jumps;
  const bool ours = random.below(2) == 0;
  const bool theirs = !ours || random.below(2) == 0;
  const Scenario scenario = clock_scenario(bench, clock, ours, theirs);
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, false);
  if (const int cycles = different_cycles(trace, bench.reference, false); cycles > 0)
    result.note("shape or commands differ in " + std::to_string(cycles) + " cycles");
  result.measured = 0;
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    const double next = i + 1 < jumps.size() ? jumps[i + 1].first : scenario.window.end;
    result.measured =
        std::max(result.measured, samples_to_lock(trace, bench.reference, jumps[i].first, next));
  }
  return result;
}

/// All senders stop and restart: their clocks from zero, a new session. Later they restart again,
/// at the end of the window.
Scenario restarted(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "restart");
  const double at = 0.25 + 1e-3 * static_cast<double>(random.below(100));
  const double pause = random.below(4) == 0 ? 0 : 1e-3 * static_cast<double>(random.below(400));
  const int again = static_cast<int>(std::lround((at + pause + 0.3) / kTick));
  Scenario scenario;
  scenario.stream = restart(bench.recording.stream, at, pause, 77);
  scenario.window = {at, kTick * again};
  scenario.ticks = again + 300;
  scenario.acts.push_back({again, [](client::Client& user) { user.send({"start"}, 0); }});
  return scenario;
}

RunResult judge_restarted(const Bench& bench, const Scenario& scenario) {
  const Window& window = scenario.window;
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, window, true);
  const auto heard = std::find_if(scenario.stream.begin(), scenario.stream.end(),
                                  [&](const bus::Published& m) { return window.holds(m.time_ns); });
  const auto first = static_cast<std::size_t>(heard->time_ns / 1'000'000);
  std::size_t inactive = first;
  while (inactive < trace.cycles.size() && trace.cycles[inactive].command_valid) ++inactive;
  result.measured = 1e3 * kTick * static_cast<double>(inactive - first);
  const auto again = static_cast<std::size_t>(std::lround(window.end / kTick));
  for (std::size_t i = inactive; i + 1 < again; ++i)
    if (trace.cycles[i].command_valid) result.fail("a command before it was started again");
  if (trace.cycles.back().state != pipeline::LifeCycle::kActive)
    result.note("is not active after it was started again");
  return result;
}

}  // namespace

std::vector<Row> sensor_rows() {
  return {
      scenario_row({"4", "NaN, Inf, 1e308 among good", "0 not finite downstream", "", 0, false, {}},
                   bad_among_good, judge_numbers),
      scenario_row({"4",
                    "NaN, Inf, 1e308 only",
                    "stale within max_age + 1 T, zero in 100 ms",
                    "ms",
                    seen_within(channel::kImu),
                    false,
                    {}},
                   only_bad, judge_stop),
      scenario_row({"4", "denormal numbers", "0 not finite downstream", "", 0, false, {}}, denormal,
                   judge_numbers),
      scenario_row({"4", "saturated sensor", "zero command in 100 ms", "ms", 100, false, {}},
                   saturated, judge_saturated),
      stop_row(channel::kFtWrench, "force-torque"),
      stop_row(channel::kRobotState, "robot state"),
      stop_row(channel::kImu, "inertial unit"),
      scenario_row({"5",
                    "hand's state stops",
                    "in HEALTH 100 ms after the next message was due",
                    "ms",
                    110.5,
                    false,
                    {}},
                   hand_stops, judge_hand_stops),
      scenario_row({"5", "target is repeated no more", "holds, to the bit", "cycles", 0, false, {}},
                   target_stops, judge_target_stops),
      frozen_row(channel::kFtWrench, "force-torque"),
      frozen_row(channel::kRobotState, "robot state"),
      frozen_row(channel::kImu, "inertial unit"),
      {"7", "wall clocks jump", "0 cycles missed, locks in 50 samples", "samples", 50, false,
       run_clock, senders_clocks},
      scenario_row({"19",
                    "simulator restarts",
                    "inactive within 1 s, no command before start",
                    "ms",
                    1000,
                    false,
                    {}},
                   restarted, judge_restarted),
  };
}

}  // namespace palpate::faults
