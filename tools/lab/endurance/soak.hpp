#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate::endurance {

struct SoakOptions {
  double minutes = 10;
  std::filesystem::path root;    // source tree
  std::filesystem::path output;  // folder for the programs' output
  std::filesystem::path json;    // empty: none
  std::uint64_t seed = 1;        // of the faults in virtual time
};

/// Resident memory over time, s and MB.
struct MemorySample {
  double time = 0;
  double megabytes = 0;
};

/// Growth between the second and the last tenth of a run (the first is warm-up), and the slope of a
/// straight line fitted after the warm-up.
struct MemoryTrend {
  double first = 0;  // MB, mean of the second tenth
  double last = 0;   // MB, mean of the last tenth
  double slope = 0;  // MB per minute
  double growth() const { return last - first; }
};

/// Throws std::invalid_argument for fewer than 20 samples.
MemoryTrend memory_trend(const std::vector<MemorySample>& samples);

/// Resident memory of a process, MB. Throws RunFailed if it has ended.
double resident_megabytes(pid_t pid);

/// Daemon and simulator in real time with changing targets; prints resident memory, overruns and
/// latency. Exit code 1 if memory grows by more than 1 MB after warm-up.
int run_soak(const SoakOptions& options);

/// Hours of closed loop in virtual time with a random mix of faults (faults::LongRun). Prints
/// faults, recoveries, memory and the error at rest of the first and of the last tenth. Exit code 1
/// if a check failed, or memory grows by more than 1 MB per hour after warm-up.
int run_virtual_soak(const SoakOptions& options);

}  // namespace palpate::endurance
