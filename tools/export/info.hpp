#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "tools/export/survey.hpp"

namespace palpate::exporting {

/// Contents of a log as a readable table: channels, types, rates, losses, times, unknown messages.
void print_info(const Survey& survey, std::ostream& out);

/// The same as data for programs; times in us, rates in Hz.
nlohmann::json info_json(const Survey& survey);

/// Every field of every channel with a known type: the names for --field and --channel, with units.
void print_fields(const Survey& survey, std::ostream& out);

}  // namespace palpate::exporting
