#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace palpate::exporting {

/// The commands of palpate-export. Each puts what it does into `chosen` when it is the one that was
/// typed; that throws std::runtime_error or config::Error.
void add_info(CLI::App& app, std::function<void()>& chosen);
void add_csv(CLI::App& app, std::function<void()>& chosen);
void add_plot(CLI::App& app, std::function<void()>& chosen);
void add_mcap(CLI::App& app, std::function<void()>& chosen);
void add_vtu(CLI::App& app, std::function<void()>& chosen);
void add_png(CLI::App& app, std::function<void()>& chosen);
void add_mp4(CLI::App& app, std::function<void()>& chosen);

}  // namespace palpate::exporting
