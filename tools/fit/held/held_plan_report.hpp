#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/fit/held/held_plan.hpp"

namespace palpate::fit {

/// The motions in order, with the expected knowledge after each, and what remains undetermined.
void print(const HeldPlan& plan, std::ostream& out);

/// The same, SI units; motions as poses of G from rest, in O.
nlohmann::json to_json(const HeldPlan& plan);

/// Adds the command `plan`, which prints the motions of the hand that would identify a
/// configuration's object best. `code` becomes its exit code once it has run. It throws
/// config::Error and std::invalid_argument.
void add_held_plan_command(CLI::App& app, int& code);

}  // namespace palpate::fit
