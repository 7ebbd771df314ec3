#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/fit/held/held_plan.hpp"

namespace palpate::fit {

/// The motions in order, with the expected knowledge after each, and what remains undetermined.
void print(const HeldPlan& plan, std::ostream& out);

/// The same, SI units; motions as poses of G from rest, in O.
nlohmann::json to_json(const HeldPlan& plan);

}  // namespace palpate::fit
