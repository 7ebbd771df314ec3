#pragma once

#include <CLI/CLI.hpp>

#include "rt/config/command_line.hpp"

namespace palpate::mesh_tool {

// Exit codes.
inline constexpr int kGood = 0, kFailed = 1, kBroken = config::kExitData;

/// box, cylinder, ellipsoid, surface: `code` becomes the exit code of the one that runs.
void add_make_commands(CLI::App& app, int& code);

/// scan: from a cloud, or from triangles with faults.
void add_scan_command(CLI::App& app, int& code);

/// check, convert, repair, optimise.
void add_file_commands(CLI::App& app, int& code);

/// regions.
void add_region_command(CLI::App& app, int& code);

}  // namespace palpate::mesh_tool
