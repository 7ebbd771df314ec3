#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace palpate::faults {

/// Outcome of a fault, worst last.
enum class Outcome { kUnaffected, kDegraded, kSafeStop, kFailed };
inline constexpr int kOutcomes = 4;
const char* name(Outcome outcome);

/// Result of one seed of one row. Plain data, so that it may come from another process. Times in s;
/// negative: never, or not applicable.
struct RunResult {
  std::uint64_t seed = 0;
  Outcome outcome = Outcome::kUnaffected;
  double visible = -1;    // from the fault until HEALTH or an event reports it
  double detected = -1;   // from the fault until a state other than active
  double recovered = -1;  // from the fault's end until active again
  double measured = -1;   // value compared with the row's bound
  bool crashed = false;
  std::array<char, 160> miss{};  // the first violation; "" if there was none

  void fail(const std::string& why);     // a check of the whole table failed: the run has failed
  void note(const std::string& why);     // a bound of the row was missed
  void append(const std::string& more);  // to the violation
  bool has_miss() const { return miss[0] != '\0'; }
};

struct Bench;
struct Scenario;

/// One kind of fault.
struct Row {
  std::string number;  // number in the table of faults
  std::string fault;
  std::string figure;  // requirement, in words
  std::string unit;    // of `measured`
  double limit;        // upper bound of `measured`; infinite: none
  bool mean = false;   // the mean over all seeds, not the maximum, is compared
  std::function<RunResult(const Bench&, std::uint64_t seed)> run;
  /// The same as messages, if it can be expressed by messages: for a process.
  std::function<Scenario(const Bench&, std::uint64_t seed)> scenario{};
};

}  // namespace palpate::faults
