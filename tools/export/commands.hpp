#pragma once

#include <CLI/CLI.hpp>
#include <functional>

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

}  // namespace palpate::exporting
