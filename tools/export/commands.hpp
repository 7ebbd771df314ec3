#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/export/csv_export.hpp"
#include "tools/export/shape_follower.hpp"
#include "tools/export/source.hpp"

namespace palpate::exporting {

/// The commands of palpate-export. Each assigns its action to `chosen` if it was given; the action
/// throws std::runtime_error or config::Error.
void add_info(CLI::App& app, std::function<void()>& chosen);
void add_csv(CLI::App& app, std::function<void()>& chosen);
void add_plot(CLI::App& app, std::function<void()>& chosen);
void add_mcap(CLI::App& app, std::function<void()>& chosen);
void add_vtu(CLI::App& app, std::function<void()>& chosen);
void add_png(CLI::App& app, std::function<void()>& chosen);
void add_mp4(CLI::App& app, std::function<void()>& chosen);
void add_merge(CLI::App& app, std::function<void()>& chosen);
void add_cut(CLI::App& app, std::function<void()>& chosen);
void add_filter(CLI::App& app, std::function<void()>& chosen);

/// Adds logs, --types, --clock, --from, --to and --quiet to a command.
void add_source(CLI::App& command, SourceOptions& options);

/// Adds --channel.
void add_channels(CLI::App& command, SourceOptions& options);

/// Prints one line for each file, and one for the omitted part of the log.
void report(const std::vector<Written>& written, const Source& source);

/// Adds --stiffness and --truth-stiffness.
void add_stiffness(CLI::App& command, FollowerOptions& options);

}  // namespace palpate::exporting
