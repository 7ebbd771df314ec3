#include "tools/doctor/finding.hpp"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace palpate::doctor {
namespace {

const char* colour(Verdict verdict) {
  constexpr const char* kNames[] = {"\x1b[32m", "\x1b[33m", "\x1b[1;31m"};
  return kNames[static_cast<std::size_t>(verdict)];
}

}  // namespace

const char* name(Verdict verdict) noexcept {
  constexpr const char* kNames[] = {"ok", "warn", "fail"};
  return kNames[static_cast<std::size_t>(verdict)];
}

void print(const Findings& findings, bool colours, bool only_bad, std::ostream& out) {
  for (const Finding& finding : findings) {
    if (only_bad && finding.verdict == Verdict::kOk) continue;
    out << (colours ? colour(finding.verdict) : "") << std::left << std::setw(6)
        << name(finding.verdict) << (colours ? "\x1b[0m" : "") << std::setw(24) << finding.check
        << finding.found << '\n';
    if (!finding.why.empty()) out << "      why:  " << finding.why << '\n';
    std::istringstream remedy(finding.remedy);
    for (std::string line; std::getline(remedy, line);) out << "      fix: " << line << '\n';
  }
}

nlohmann::json to_json(const Findings& findings) {
  nlohmann::json json = {{"version", PALPATE_VERSION},
                         {"verdict", name(worst(findings))},
                         {"findings", nlohmann::json::array()}};
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"check", finding.check},
                                {"verdict", name(finding.verdict)},
                                {"found", finding.found},
                                {"why", finding.why},
                                {"remedy", finding.remedy}});
  }
  return json;
}

Verdict worst(const Findings& findings) {
  Verdict verdict = Verdict::kOk;
  for (const Finding& finding : findings) verdict = std::max(verdict, finding.verdict);
  return verdict;
}

}  // namespace palpate::doctor
