#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::studies {

/// The I-th of N parts of a study, I from 1.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// Parses "I/N". Throws std::invalid_argument unless 1 <= I <= N.
Shard read_shard(const std::string& text);

/// The shard's part of a list: every N-th entry, so that long and short ones are distributed
/// evenly. The N parts hold each entry once.
template <class Entry>
std::vector<Entry> shard_of(const std::vector<Entry>& all, const Shard& shard) {
  std::vector<Entry> part;
  for (std::size_t i = shard.index - 1; i < all.size(); i += shard.count) part.push_back(all[i]);
  return part;
}

}  // namespace palpate::studies
