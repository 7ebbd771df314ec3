#pragma once

#include <functional>
#include <string>

#include "rt/config/command_line.hpp"

namespace palpate::common {

/// Runs the body of a program and returns its exit code. What it throws is printed to standard
/// error after "`prefix`: ": Interrupted becomes kExitInterrupted, config::Error 78, any other
/// exception `failed`.
int run_program(const std::string& prefix, const std::function<int()>& body,
                int failed = config::kExitError);

}  // namespace palpate::common
