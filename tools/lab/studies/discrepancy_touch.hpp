#pragma once

#include <cstdint>
#include <optional>

#include "tools/lab/studies/discrepancy_world.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// Instants of the truth, us.
struct TouchTimes {
  std::int64_t first = 0, last = 0;
};

/// When the plant touches an obstacle for the first and for the last time: a point of its surface,
/// of a grid of 4 mm, is within 0.3 mm of it; empty: never. Throws std::runtime_error if the log
/// lacks the plant's mesh.
std::optional<TouchTimes> find_touch(const log::RunLog& log, const RigidObstacle& obstacle);

}  // namespace palpate::studies
