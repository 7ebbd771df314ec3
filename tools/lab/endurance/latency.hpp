#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <utility>
#include <vector>

namespace palpate::endurance {

/// How late wake-ups came, or how long cycles took: a row of pairs, falling, of the share that is
/// above a latency, and that latency in us.
struct LatencyTail {
  std::vector<std::pair<double, double>> pairs;
  std::int64_t count = 0;
  double missed = 0;  // share that came a period late or later, or lasted a period
  double max = 0;     // us
  /// us that all but `share` keep to.
  double at(double share) const;
};

/// The histogram that cyclictest -h writes: microseconds and how often, and what went beyond.
/// Throws std::runtime_error where it holds nothing. `period`: us.
LatencyTail read_cyclictest(std::istream& in, double period);

struct LatencyOptions {
  double seconds = 60;  // each measurement
  bool stressed = true;
  std::filesystem::path root;          // source tree
  std::filesystem::path output;        // folder of what the programs print, and of the picture
  std::filesystem::path json;          // summary; empty: none
  std::vector<std::string> overrides;  // of palpated
};

/// palpated beside the simulator, going to and fro between two targets, and cyclictest of the same
/// priority at the same time; once as the machine is, once with stress-ng on all its processors.
/// Prints both, draws their distributions. 1 where the loop missed by more than 0.1 % of its cycles
/// more than cyclictest did. Throws where a program is missing.
int run_latency(const LatencyOptions& options);

}  // namespace palpate::endurance
