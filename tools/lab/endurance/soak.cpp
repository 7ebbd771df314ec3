#include "tools/lab/endurance/soak.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::endurance {
namespace {

constexpr double kMostGrowth = 1.0;       // MB
constexpr double kSoakTargetPeriod = 15;  // s until the target changes
constexpr double kSampling = 1.0;         // s
constexpr const char* kSoakScene = "sim/scenes/bar_long_soft_control.yaml";
constexpr const char* kSoakConfiguration = "rt/config/examples/bar_long_soft.yaml";

double mean(const std::vector<MemorySample>& samples, std::size_t first, std::size_t last) {
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) sum += samples[i].megabytes;
  return sum / static_cast<double>(last - first);
}

void print_header() {
  common::Table({"      s", "resident MB", "overruns", "late ms", "p50 us", "p99", "p99.9", "max"})
      .print(std::cout);
}

void print_line(const MemorySample& sample, const health_t& health) {
  char text[160];
  std::snprintf(text, sizeof text, "%7.0f  %11.2f  %8lld  %7.1f  %6.0f  %3.0f  %5.0f  %3.0f\n",
                sample.time, sample.megabytes, static_cast<long long>(health.overruns),
                static_cast<double>(health.overrun_us) * 1e-3, health.p50_us[0], health.p99_us[0],
                health.p999_us[0], health.max_us[0]);
  std::cout << text << std::flush;
}

/// Two targets of the same feature, to alternate between.
std::vector<runs::ControlTarget> pair_of_targets(const std::filesystem::path& file) {
  std::vector<runs::ControlTarget> targets = runs::read_targets(file);
  const std::string kind = targets.at(0).kind;
  targets.erase(std::remove_if(targets.begin(), targets.end(),
                               [&kind](const runs::ControlTarget& t) { return t.kind != kind; }),
                targets.end());
  return targets;
}

}  // namespace

double resident_megabytes(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  throw runs::RunFailed("the program has ended");
}

MemoryTrend memory_trend(const std::vector<MemorySample>& samples) {
  if (samples.size() < 20) throw std::invalid_argument("a memory trend wants 20 samples");
  const std::size_t n = samples.size(), tenth = n / 10;
  MemoryTrend trend;
  trend.first = mean(samples, tenth, 2 * tenth);
  trend.last = mean(samples, n - tenth, n);
  double t_mean = 0, m_mean = mean(samples, tenth, n), covariance = 0, variance = 0;
  for (std::size_t i = tenth; i < n; ++i)
    t_mean += samples[i].time / static_cast<double>(n - tenth);
  for (std::size_t i = tenth; i < n; ++i) {
    covariance += (samples[i].time - t_mean) * (samples[i].megabytes - m_mean);
    variance += (samples[i].time - t_mean) * (samples[i].time - t_mean);
  }
  trend.slope = 60 * covariance / variance;
  return trend;
}

int run_soak(const SoakOptions& options) {
  common::catch_interruptions();
  const auto targets = pair_of_targets(options.root / "tools/lab/studies/targets.yaml");
  runs::RunPlan plan;
  plan.name = "soak";
  plan.source.scene = options.root / kSoakScene;
  plan.configuration = options.root / kSoakConfiguration;
  plan.overrides = targets[0].daemon_overrides();
  plan.recorded = false;
  runs::LiveRun run(plan, options.output);

  const double duration = options.minutes * 60;
  const std::int64_t begin = bus::wall_clock_us();
  std::vector<MemorySample> samples;
  double next_target = 0, next_line = 0;
  std::size_t given = 0;
  print_header();
  for (double time = 0; time < duration;
       time = static_cast<double>(bus::wall_clock_us() - begin) * 1e-6) {
    if (time >= next_target) {
      run.set_target(targets[given++ % targets.size()]);
      next_target += kSoakTargetPeriod;
    }
    run.spin(kSampling);
    if (!run.check_programs()) throw runs::RunFailed("palpate-sim ended before its time");
    samples.push_back({time, resident_megabytes(run.daemon_pid())});
    if (time >= next_line) {
      print_line(samples.back(), *run.client().health());
      next_line += std::max(10.0, duration / 20);
    }
  }
  const health_t health = *run.client().health();
  print_line(samples.back(), health);
  run.finish();

  const MemoryTrend trend = memory_trend(samples);
  const bool flat = trend.growth() <= kMostGrowth;
  std::cout << "resident memory of palpated: " << common::number(trend.first, 2)
            << " MB after warm-up, " << common::number(trend.last, 2) << " MB at the end, slope "
            << common::number(trend.slope, 4) << " MB/min; " << health.overruns << " overruns in "
            << health.cycles << " cycles\n"
            << (flat ? "memory is flat\n" : "MEMORY GROWS by more than 1 MB\n");
  if (!options.json.empty())
    common::write_json({{"minutes", options.minutes},
                        {"resident_first_mb", trend.first},
                        {"resident_last_mb", trend.last},
                        {"slope_mb_per_minute", trend.slope},
                        {"cycles", health.cycles},
                        {"overruns", health.overruns},
                        {"overrun_ms", static_cast<double>(health.overrun_us) * 1e-3},
                        {"latency_us",
                         {{"p50", health.p50_us[0]},
                          {"p99", health.p99_us[0]},
                          {"p99.9", health.p999_us[0]},
                          {"max", health.max_us[0]}}}},
                       options.json);
  return flat ? 0 : 1;
}

}  // namespace palpate::endurance
