#pragma once

#include <nlohmann/json_fwd.hpp>

namespace palpate::studies {

/// The machine: processor, cores, kernel, memory, and its load at this moment. What cannot be read
/// says "unknown".
nlohmann::json describe_host();

}  // namespace palpate::studies
