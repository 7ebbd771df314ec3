#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/record/recorder.hpp"

namespace palpate::record {

/// Recorded, rejected and lost messages: a table of the channels, and one line each for URLs and
/// files. `seconds`: duration.
void print_summary(const Recorder& recorder, const Listener& listener, double seconds,
                   std::ostream& out);

/// The same as data for programs.
nlohmann::json summary_json(const Recorder& recorder, const Listener& listener, double seconds);

}  // namespace palpate::record
