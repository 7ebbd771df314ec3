#pragma once

#include <CLI/CLI.hpp>

namespace palpate::fit {

/// Adds the command `export`, which writes a configuration's object as models of other simulators.
/// `code` becomes its exit code once it has run. It throws config::Error and std::runtime_error.
void add_export_command(CLI::App& app, int& code);

}  // namespace palpate::fit
