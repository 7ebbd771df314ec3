#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <utility>
#include <vector>

namespace palpate::endurance {

/// Distribution of wake-up latency or cycle time: rows of the fraction above a latency, descending,
/// and that latency in us.
struct LatencyTail {
  std::vector<std::pair<double, double>> pairs;
  std::int64_t count = 0;
  double missed = 0;  // fraction that was late by a period or more, or lasted that long
  double max = 0;     // us
  /// Latency in us that is exceeded only by the fraction `share`.
  double at(double share) const;
};

/// The histogram written by cyclictest -h: microseconds and counts, and the overflow. Throws
/// std::runtime_error if it is empty. `period`: us.
LatencyTail read_cyclictest(std::istream& in, double period);

struct LatencyOptions {
  double seconds = 60;  // each measurement
  bool stressed = true;
  std::filesystem::path root;          // source tree
  std::filesystem::path output;        // folder for the programs' output and the plot
  std::filesystem::path json;          // summary; empty: none
  std::vector<std::string> overrides;  // of palpated
};

/// Runs palpated with the simulator, alternating between two targets, and cyclictest at the same
/// priority simultaneously; once on the unloaded machine, once with stress-ng on all its
/// processors. Prints both, plots their distributions. Returns 1 if the fraction of missed cycles
/// exceeds that of cyclictest by more than 0.1 %. Throws if a program is missing.
int run_latency(const LatencyOptions& options);

}  // namespace palpate::endurance
