#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/record/recorder.hpp"

namespace palpate::record {

/// What was recorded, refused and lost: a table of the channels, and a line each for URLs and
/// files. `seconds`: that it took.
void print_summary(const Recorder& recorder, const Listener& listener, double seconds,
                   std::ostream& out);

/// The same to be read by programs.
nlohmann::json summary_json(const Recorder& recorder, const Listener& listener, double seconds);

}  // namespace palpate::record
