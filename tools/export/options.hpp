#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/export/csv_export.hpp"
#include "tools/export/shape_follower.hpp"
#include "tools/export/source.hpp"

namespace palpate::exporting {

/// Adds logs, --clock, --from, --to and --quiet to a command.
void add_source(CLI::App& command, SourceOptions& options);

/// Adds --channel.
void add_channels(CLI::App& command, SourceOptions& options);

/// Prints one line for each file, and one for the omitted part of the log.
void report(const std::vector<Written>& written, const Source& source);

/// Adds --stiffness and --truth-stiffness.
void add_stiffness(CLI::App& command, FollowerOptions& options);

}  // namespace palpate::exporting
