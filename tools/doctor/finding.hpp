#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::doctor {

enum class Verdict { kOk, kWarn, kFail };
const char* name(Verdict verdict) noexcept;

/// Result of one check.
struct Finding {
  std::string check;  // its name, one word
  Verdict verdict = Verdict::kOk;
  std::string found;   // one line
  std::string why;     // reason why it matters; empty if all is well
  std::string remedy;  // commands that fix it, one per line; empty if there are none
};

using Findings = std::vector<Finding>;

inline Finding ok(std::string check, std::string found) {
  return {std::move(check), Verdict::kOk, std::move(found), "", ""};
}
inline Finding warn(std::string check, std::string found, std::string why, std::string remedy) {
  return {std::move(check), Verdict::kWarn, std::move(found), std::move(why), std::move(remedy)};
}
inline Finding fail(std::string check, std::string found, std::string why, std::string remedy) {
  return {std::move(check), Verdict::kFail, std::move(found), std::move(why), std::move(remedy)};
}

/// One line each; failed checks are followed by the reason and the fix. `only_bad` omits the
/// others.
void print(const Findings& findings, bool colours, bool only_bad, std::ostream& out);

nlohmann::json to_json(const Findings& findings);

/// The worst verdict.
Verdict worst(const Findings& findings);

}  // namespace palpate::doctor
