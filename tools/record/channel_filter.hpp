#pragma once

#include <regex>
#include <string>
#include <string_view>
#include <unordered_map>

namespace palpate::record {

/// Which channels are wanted: those whose whole name a regular expression matches, or all others.
class ChannelFilter {
 public:
  /// Throws std::invalid_argument where `pattern` is no regular expression (ECMAScript).
  explicit ChannelFilter(const std::string& pattern = ".*", bool invert = false);

  bool wants(std::string_view channel);

 private:
  std::regex pattern_;
  bool all_, invert_;
  std::unordered_map<std::string, bool> known_;  // answers given before
};

}  // namespace palpate::record
