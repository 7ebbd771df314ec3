#pragma once

#include <string>
#include <vector>

#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {

/// The I-th of N parts of a study, I from 1.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// Parses "I/N". Throws std::invalid_argument unless 1 <= I <= N.
Shard read_shard(const std::string& text);

/// The shard's part of `tasks`: every N-th, so that long and short ones are distributed evenly. The
/// N parts hold each task once.
std::vector<Task> shard_of(const std::vector<Task>& tasks, const Shard& shard);

}  // namespace palpate::studies
