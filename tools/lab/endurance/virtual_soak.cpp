// Soak in virtual time; see soak.hpp.

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tools/common/bootstrap.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/endurance/soak.hpp"
#include "tools/lab/faults/long_run.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::endurance {
namespace {

constexpr int kSamples = 200;            // of memory, in the whole run
constexpr double kMostGrowthHour = 1.0;  // MB

double median_mm(std::vector<double>::const_iterator first,
                 std::vector<double>::const_iterator last) {
  return first == last ? 0 : 1e3 * common::median_of({first, last}).value;
}

void print(const faults::LongRunReport& report) {
  int count = 0;
  for (const auto& [fault, times] : report.faults) {
    count += times;
    std::cout << "  " << times << "  " << fault << '\n';
  }
  std::cout << count << " faults in " << common::number(report.time / 3600, 2)
            << " h of virtual time, " << std::llround(report.time * 1e3) << " cycles; "
            << report.messages << " messages of the daemon looked at\n"
            << "reset or started again " << report.stops << " times; active at most "
            << common::number(report.slowest_recovery, 2) << " s after a fault's end\n"
            << "answers to commands: " << report.replaced << " components replaced, "
            << report.refused << " refused\n";
}

}  // namespace

int run_virtual_soak(const SoakOptions& options) {
  common::catch_interruptions();
  faults::LongRun run(options.seed);
  const double duration = 60 * options.minutes;
  std::vector<MemorySample> samples;
  common::Progress progress(1, 1, "virtual time");
  for (int i = 1; i <= kSamples; ++i) {
    run.run(duration / kSamples);
    common::throw_if_interrupted();
    samples.push_back({run.report().time, resident_megabytes(getpid())});
    progress.show(static_cast<double>(i) / kSamples,
                  std::to_string(run.report().failures) + " failures");
  }
  const faults::LongRunReport& report = run.report();
  const MemoryTrend memory = memory_trend(samples);
  const bool flat = 60 * memory.slope <= kMostGrowthHour;
  const bool good = report.failures == 0 && flat;
  progress.finish(good);

  const std::vector<double>& errors = report.errors;
  const auto tenth = static_cast<std::ptrdiff_t>(errors.size() / 10);
  const double first = median_mm(errors.begin(), errors.begin() + tenth),
               last = median_mm(errors.end() - tenth, errors.end());
  const double most = errors.empty() ? 0 : 1e3 * *std::max_element(errors.begin(), errors.end());
  print(report);
  std::cout << "error of the plant before each fault, median: first tenth "
            << common::number(first, 2) << " mm, last tenth " << common::number(last, 2)
            << " mm; largest " << common::number(most, 2) << " mm\n"
            << "resident memory, simulator included: " << common::number(memory.first, 2)
            << " MB after warm-up, " << common::number(memory.last, 2) << " MB at the end, slope "
            << common::number(60 * memory.slope, 3) << " MB/h" << (flat ? "" : ": MEMORY GROWS")
            << '\n'
            << report.failures << " failures\n";
  for (const std::string& complaint : report.complaints) std::cout << "  " << complaint << '\n';
  if (!options.json.empty())
    common::write_json({{"hours", report.time / 3600},
                        {"seed", options.seed},
                        {"faults", report.faults},
                        {"messages", report.messages},
                        {"stops", report.stops},
                        {"slowest_recovery_s", report.slowest_recovery},
                        {"replaced", report.replaced},
                        {"refused", report.refused},
                        {"error_first_tenth_mm", first},
                        {"error_last_tenth_mm", last},
                        {"error_largest_mm", most},
                        {"resident_first_mb", memory.first},
                        {"resident_last_mb", memory.last},
                        {"slope_mb_per_hour", 60 * memory.slope},
                        {"failures", report.failures},
                        {"complaints", report.complaints}},
                       options.json);
  return good ? 0 : 1;
}

}  // namespace palpate::endurance
