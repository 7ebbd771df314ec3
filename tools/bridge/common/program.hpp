#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "bridged_arm.hpp"
#include "rt/config/node.hpp"
#include "tools/driver/driver.hpp"

// What the programs of all bridges to arms do.

namespace palpate::bridge {

/// main() of a bridge: options --config and --set, signals, exit codes. `about` and `example` are
/// parts of --help. `body` gets the configuration and the name of its file, and ends soon after a
/// signal, as run() does.
int bridge_main(const std::string& about, const std::string& example, int argc,
                const char* const* argv,
                const std::function<void(const config::Node&, const std::string& file)>& body);

/// Of the machine's clocks; what is said goes to standard error.
BridgedArm::Options machine_options(double stale);

/// Runs until a signal, then prints what has been counted. See driver::run.
void run(driver::Driver& cell, bus::MessageBus& control, const BridgedArm& arm,
         const std::function<void(std::int64_t utime)>& also = {},
         const std::function<void(std::int64_t until_ns)>& wait = {});

/// Without an arm: calls `each` with the wall clock, us, in cycles of 1 ms until a signal, after
/// the bus has received, which this starts.
void run(bus::MessageBus& control, const std::function<void(std::int64_t utime)>& each);

}  // namespace palpate::bridge
