#pragma once

#include <CLI/CLI.hpp>

namespace palpate::fit {

/// Adds the command `plan`, which prints the motions of the hand that would identify a
/// configuration's object best. `code` becomes its exit code once it has run. It throws
/// config::Error and std::invalid_argument.
void add_held_plan_command(CLI::App& app, int& code);

}  // namespace palpate::fit
