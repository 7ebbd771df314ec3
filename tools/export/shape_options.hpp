#pragma once

#include <CLI/CLI.hpp>

#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// Adds --stiffness and --truth-stiffness.
void add_stiffness(CLI::App& command, FollowerOptions& options);

}  // namespace palpate::exporting
