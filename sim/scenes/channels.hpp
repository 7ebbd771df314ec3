#pragma once

#include <string>

namespace palpate::scenes {

/// What a channel of arm 0 or of arm 1 is called: the second one's names end in _1.
inline std::string channel_of(const std::string& channel, int arm) {
  return arm == 0 ? channel : channel + "_" + std::to_string(arm);
}

}  // namespace palpate::scenes
