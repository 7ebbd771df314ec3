#pragma once

#include <regex>
#include <string>
#include <string_view>
#include <unordered_map>

namespace palpate::record {

/// Selection of channels: those whose whole name matches a regular expression, or all others.
class ChannelFilter {
 public:
  /// Throws std::invalid_argument if `pattern` is not a regular expression (ECMAScript).
  explicit ChannelFilter(const std::string& pattern = ".*", bool invert = false);

  bool wants(std::string_view channel);

 private:
  std::regex pattern_;
  bool all_, invert_;
  std::unordered_map<std::string, bool> known_;  // cached answers
};

}  // namespace palpate::record
