#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/doctor/finding.hpp"

namespace palpate::doctor {

/// A line each; below those that are not well why it matters and what mends it. `only_bad` leaves
/// out the rest.
void print(const Findings& findings, bool colours, bool only_bad, std::ostream& out);

nlohmann::json to_json(const Findings& findings);

/// The worst verdict.
Verdict worst(const Findings& findings);

}  // namespace palpate::doctor
