#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/doctor/finding.hpp"

namespace palpate::doctor {

/// One line each; failed checks are followed by the reason and the fix. `only_bad` omits the
/// others.
void print(const Findings& findings, bool colours, bool only_bad, std::ostream& out);

nlohmann::json to_json(const Findings& findings);

/// The worst verdict.
Verdict worst(const Findings& findings);

}  // namespace palpate::doctor
