#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "tools/export/survey.hpp"

namespace palpate::exporting {

/// What a log holds, as a table for people: channels, types, rates, losses, times, strangers.
void print_info(const Survey& survey, std::ostream& out);

/// The same for programs; times in us, rates in Hz.
nlohmann::json info_json(const Survey& survey);

/// Every field of every channel of our types: what --field and --channel can name, with units.
void print_fields(const Survey& survey, std::ostream& out);

}  // namespace palpate::exporting
