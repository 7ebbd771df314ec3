#pragma once

#include <nlohmann/json_fwd.hpp>

namespace palpate::studies {

/// The machine: processor, cores, kernel, memory, and current load. Unreadable items are "unknown".
nlohmann::json describe_host();

}  // namespace palpate::studies
