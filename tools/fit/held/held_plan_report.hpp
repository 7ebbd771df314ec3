#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/fit/held/held_plan.hpp"

namespace palpate::fit {

/// The motions in their order, with what is expected to be known after each, and what stays open.
void print(const HeldPlan& plan, std::ostream& out);

/// The same, SI units; motions as poses of G from rest, in O.
nlohmann::json to_json(const HeldPlan& plan);

}  // namespace palpate::fit
