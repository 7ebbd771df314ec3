#include "tools/lab/faults/result.hpp"

#include <algorithm>

namespace palpate::faults {

const char* name(Outcome outcome) {
  constexpr std::array<const char*, kOutcomes> kNames = {"unaffected", "degraded", "safe stop",
                                                         "failed"};
  return kNames[static_cast<int>(outcome)];
}

void RunResult::note(const std::string& why) {
  if (has_miss()) return;
  miss.fill('\0');
  std::copy_n(why.begin(), std::min(why.size(), miss.size() - 1), miss.begin());
}

void RunResult::fail(const std::string& why) {
  if (outcome != Outcome::kFailed) miss.fill('\0');
  outcome = Outcome::kFailed;
  note(why);
}

void RunResult::append(const std::string& more) {
  const std::string whole = miss.data() + more;
  miss.fill('\0');
  note(whole);
}

}  // namespace palpate::faults
