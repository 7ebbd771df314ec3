#pragma once

#include <string>

namespace palpate::scenes {

/// Name of a channel for arm 0 or arm 1; names for the second arm end in _1.
inline std::string channel_of(const std::string& channel, int arm) {
  return arm == 0 ? channel : channel + "_" + std::to_string(arm);
}

}  // namespace palpate::scenes
