#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace palpate::faults {

/// How a daemon took a fault, worst last.
enum class Outcome { kUnaffected, kDegraded, kSafeStop, kFailed };
inline constexpr int kOutcomes = 4;
const char* name(Outcome outcome);

/// Of one seed of one row. Plain data, so that it may come from another process. Times in s, below
/// zero: not at all, or not asked for.
struct RunResult {
  std::uint64_t seed = 0;
  Outcome outcome = Outcome::kUnaffected;
  double visible = -1;    // from the fault until HEALTH or an event tells
  double detected = -1;   // from the fault until a state other than active
  double recovered = -1;  // from the fault's end until active again
  double measured = -1;   // the row's figure
  bool crashed = false;
  std::array<char, 160> miss{};  // the first thing that was not as it must; "" where all was

  void fail(const std::string& why);  // a bar of the whole table: the run has failed
  void note(const std::string& why);  // a figure of the row that was not met
  bool has_miss() const { return miss[0] != '\0'; }
};

struct Bench;
struct Scenario;

/// One kind of fault.
struct Row {
  std::string number;  // of the table of faults
  std::string fault;
  std::string figure;  // to meet, in words
  std::string unit;    // of `measured`
  double limit;        // that `measured` must not exceed; infinite: none
  bool mean = false;   // of all seeds, not the largest, is what counts
  std::function<RunResult(const Bench&, std::uint64_t seed)> run;
  /// The same as messages, where it is done with messages: for a process.
  std::function<Scenario(const Bench&, std::uint64_t seed)> scenario{};
};

}  // namespace palpate::faults
