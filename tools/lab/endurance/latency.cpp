#include "tools/lab/endurance/latency.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::endurance {
namespace {

constexpr double kLatencyPeriod = 1000;   // us
constexpr double kAllowed = 1e-3;         // of all cycles, beyond what cyclictest misses
constexpr double kTargetPeriod = 10;      // s until the target changes
constexpr int kPriority = 50;             // of the loop by default
constexpr int kLargestLatency = 100'000;  // us, of cyclictest's histogram
constexpr const char* kScene = "sim/scenes/bar_long_soft_control.yaml";
constexpr const char* kLatencyConfiguration = "rt/config/examples/bar_long_soft.yaml";

/// The slowest parts of a cycle.
constexpr const char* kPhases[] = {"estimation", "feature", "control", "publish"};

/// One measurement: the machine unloaded, or under stress.
struct Measured {
  std::string name;
  LatencyTail cyclictest, wake_up, cycle;
  std::vector<LatencyTail> phases;
  double missed = 0;  // fraction of the loop's cycles that were overruns of either kind
  double stolen = 0;  // fraction of all processors' time stolen by the hypervisor
  std::int64_t page_faults = 0, allocations = 0;
};

/// Ticks of all processors: all of them, and stolen.
std::pair<double, double> processor_times() {
  std::ifstream file("/proc/stat");
  std::string word;
  file >> word;
  double all = 0, stolen = 0, ticks = 0;
  for (int i = 0; i < 8 && file >> ticks; ++i) {
    all += ticks;
    if (i == 7) stolen = ticks;
  }
  return {all, stolen};
}

LatencyTail tail_of(const nlohmann::json& json, std::int64_t cycles) {
  LatencyTail tail;
  for (const auto& pair : json.at("tail"))
    tail.pairs.emplace_back(pair.at(0).get<double>(), pair.at(1).get<double>());
  tail.pairs.emplace_back(0.5, json.at("p50").get<double>());
  tail.pairs.emplace_back(0.01, json.at("p99").get<double>());
  tail.pairs.emplace_back(0.001, json.at("p99.9").get<double>());
  std::sort(tail.pairs.rbegin(), tail.pairs.rend());
  tail.count = cycles;
  tail.max = json.at("max");
  tail.pairs.emplace_back(1 / static_cast<double>(std::max<std::int64_t>(1, cycles)), tail.max);
  tail.missed = json.at("above_period");
  return tail;
}

std::vector<runs::ControlTarget> targets_of(const std::filesystem::path& root) {
  std::vector<runs::ControlTarget> targets =
      runs::read_targets(root / "tools/lab/studies/targets.yaml");
  const std::string kind = targets.at(0).kind;
  targets.erase(std::remove_if(targets.begin(), targets.end(),
                               [&kind](const runs::ControlTarget& t) { return t.kind != kind; }),
                targets.end());
  return targets;
}

Measured measure(const LatencyOptions& options, const std::string& name, bool stressed) {
  const std::filesystem::path folder = options.output / common::file_name(name);
  const auto targets = targets_of(options.root);
  runs::RunPlan plan;
  plan.name = name;
  plan.source.scene = options.root / kScene;
  plan.configuration = options.root / kLatencyConfiguration;
  plan.overrides = targets[0].daemon_overrides();
  // The time limits must not end the measurement early.
  plan.overrides.push_back("loop.safe_stop_after_ms=5000");
  plan.overrides.insert(plan.overrides.end(), options.overrides.begin(), options.overrides.end());
  plan.recorded = false;
  runs::LiveRun run(plan, folder);
  run.set_target(targets[0]);
  run.spin(2);

  const std::filesystem::path histogram = folder / "cyclictest.txt";
  const auto [all_before, stolen_before] = processor_times();
  const health_t before = *run.client().health();
  const std::string seconds = std::to_string(std::lround(options.seconds));
  std::optional<common::Process> stress;
  if (stressed)
    stress.emplace("stress-ng",
                   std::vector<std::string>{"stress-ng", "--cpu", "0", "--vm", "1", "--vm-bytes",
                                            "256M", "--io", "1", "--timeout", seconds},
                   folder / "stress-ng.txt");
  common::Process cyclictest(
      "cyclictest",
      {"cyclictest", "--mlockall", "--quiet", "--priority", std::to_string(kPriority), "--interval",
       std::to_string(std::lround(kLatencyPeriod)), "--duration", seconds, "--histogram",
       std::to_string(kLargestLatency)},
      histogram);
  double next_target = kTargetPeriod;
  std::size_t given = 1;
  for (double time = 0; cyclictest.running(); time += 0.2) {
    if (time >= next_target) {
      run.set_target(targets[given++ % targets.size()]);
      next_target += kTargetPeriod;
    }
    run.spin(0.2);
    if (!run.check_programs()) throw runs::RunFailed("palpate-sim ended before its time");
  }
  if (cyclictest.wait(0).value_or(1) != 0)
    throw runs::RunFailed("cyclictest failed:\n" + common::tail(histogram, 5));
  const health_t after = *run.client().health();
  const auto [all_after, stolen_after] = processor_times();
  if (stress) stress->stop();
  const runs::RunFiles files = run.finish();

  Measured measured;
  measured.name = name;
  std::ifstream text(histogram);
  measured.cyclictest = read_cyclictest(text, kLatencyPeriod);
  const auto statistics = nlohmann::json::parse(std::ifstream(files.daemon));
  const std::int64_t cycles = statistics.at("cycles");
  measured.wake_up = tail_of(statistics.at("latency_us").at("wake-up"), cycles);
  measured.cycle = tail_of(statistics.at("latency_us").at("all"), cycles);
  for (const char* phase : kPhases)
    measured.phases.push_back(tail_of(statistics.at("latency_us").at(phase), cycles));
  measured.missed = static_cast<double>(after.overruns - before.overruns) /
                    static_cast<double>(std::max<std::int64_t>(1, after.cycles - before.cycles));
  measured.stolen = (stolen_after - stolen_before) / std::max(1.0, all_after - all_before);
  measured.page_faults = after.page_faults;
  measured.allocations = after.allocations;
  return measured;
}

std::vector<std::string> row(const std::string& name, const LatencyTail& tail, double missed) {
  return {name,
          std::to_string(tail.count),
          common::number(tail.at(0.5), 0),
          common::number(tail.at(0.01), 0),
          common::number(tail.at(0.001), 0),
          common::number(tail.max, 0),
          common::number(100 * missed, 3)};
}

common::Curve curve(const std::string& title, const LatencyTail& tail) {
  common::Curve result;
  result.title = title;
  for (const auto& [share, latency] : tail.pairs) {
    result.x.push_back(std::max(1.0, latency));
    result.y.push_back(share);
  }
  return result;
}

nlohmann::json to_json(const LatencyTail& tail) {
  return {{"count", tail.count},     {"p50", tail.at(0.5)}, {"p99", tail.at(0.01)},
          {"p99.9", tail.at(0.001)}, {"max", tail.max},     {"missed", tail.missed}};
}

}  // namespace

double LatencyTail::at(double share) const {
  for (const auto& [above, latency] : pairs)
    if (above <= share) return latency;
  return max;
}

LatencyTail read_cyclictest(std::istream& in, double period) {
  std::vector<std::pair<double, std::int64_t>> buckets;
  LatencyTail tail;
  std::int64_t beyond = 0;
  for (std::string line; std::getline(in, line);) {
    const auto value = [&line] { return std::stoll(line.substr(line.find(':') + 1)); };
    if (line.rfind("# Max Latencies:", 0) == 0) tail.max = static_cast<double>(value());
    if (line.rfind("# Histogram Overflows:", 0) == 0) beyond = value();
    if (line.empty() || line[0] == '#' || line[0] == '/') continue;
    std::istringstream words(line);
    double latency = 0;
    std::int64_t count = 0;
    if (words >> latency >> count && count > 0) buckets.emplace_back(latency, count);
  }
  tail.count = beyond;
  for (const auto& [latency, count] : buckets) tail.count += count;
  if (tail.count == 0) throw std::runtime_error("cyclictest has measured nothing");
  std::int64_t above = tail.count, missed = beyond;
  for (const auto& [latency, count] : buckets) {
    above -= count;
    if (latency >= period) missed += count;
    if (above > 0)
      tail.pairs.emplace_back(static_cast<double>(above) / static_cast<double>(tail.count),
                              latency);
  }
  tail.pairs.emplace_back(1 / static_cast<double>(tail.count), tail.max);
  tail.missed = static_cast<double>(missed) / static_cast<double>(tail.count);
  return tail;
}

int run_latency(const LatencyOptions& options) {
  common::catch_interruptions();
  std::filesystem::create_directories(options.output);
  std::vector<Measured> all;
  all.push_back(measure(options, "as it is", false));
  if (options.stressed) all.push_back(measure(options, "stress-ng", true));

  common::Table table({"us", "samples", "p50", "p99", "p99.9", "max", "missed %"});
  std::vector<common::Plot> plots;
  nlohmann::json json;
  bool good = true;
  for (const Measured& one : all) {
    table.section(one.name + ", " + common::number(100 * one.stolen, 2) +
                  " % of the processors stolen");
    table.add(row("cyclictest, wake-up", one.cyclictest, one.cyclictest.missed));
    table.add(row("loop, wake-up", one.wake_up, one.wake_up.missed));
    table.add(row("loop, whole cycle", one.cycle, one.missed));
    for (std::size_t i = 0; i < one.phases.size(); ++i)
      table.add(row("  of it " + std::string(kPhases[i]), one.phases[i], one.phases[i].missed));
    common::Plot plot;
    plot.title = one.name;
    plot.x_label = "us";
    plot.y_label = "share above";
    plot.logarithmic = plot.logarithmic_x = true;
    plot.curves = {curve("cyclictest, wake-up", one.cyclictest),
                   curve("loop, wake-up", one.wake_up), curve("loop, whole cycle", one.cycle)};
    plots.push_back(plot);
    good = good && one.missed <= one.cyclictest.missed + kAllowed;
    json[one.name] = {{"cyclictest", to_json(one.cyclictest)},
                      {"wake_up", to_json(one.wake_up)},
                      {"cycle", to_json(one.cycle)},
                      {"overruns_share", one.missed},
                      {"stolen_share", one.stolen},
                      {"page_faults", one.page_faults},
                      {"allocations", one.allocations}};
    for (std::size_t i = 0; i < one.phases.size(); ++i)
      json[one.name]["phases"][kPhases[i]] = to_json(one.phases[i]);
  }
  table.print(std::cout);
  for (const Measured& one : all)
    std::cout << one.name << ": " << one.page_faults << " page faults and " << one.allocations
              << " allocations of the loop\n";
  if (common::try_draw(plots, options.output / "latency.png"))
    std::cout << "distributions: " << (options.output / "latency.png").string() << "\n";
  std::cout << (good ? "the loop misses no more than cyclictest does and 0.1 %\n"
                     : "THE LOOP MISSES MORE than cyclictest does and 0.1 %\n");
  if (!options.json.empty()) common::write_json(json, options.json);
  return good ? 0 : 1;
}

}  // namespace palpate::endurance
