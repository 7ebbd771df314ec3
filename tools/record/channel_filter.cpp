#include "tools/record/channel_filter.hpp"

#include <stdexcept>

namespace palpate::record {
namespace {

constexpr std::size_t kMostKnown = 4096;  // names; a sender of random names must not exhaust memory

std::regex compiled(const std::string& pattern) {
  try {
    return std::regex(pattern, std::regex::ECMAScript | std::regex::optimize);
  } catch (const std::regex_error& error) {
    throw std::invalid_argument("\"" + pattern + "\" is no regular expression: " + error.what());
  }
}

}  // namespace

ChannelFilter::ChannelFilter(const std::string& pattern, bool invert)
    : pattern_(compiled(pattern)), all_(pattern == ".*"), invert_(invert) {}

bool ChannelFilter::wants(std::string_view channel) {
  if (all_) return !invert_;
  std::string name(channel);
  const auto found = known_.find(name);
  if (found != known_.end()) return found->second;
  const bool wanted = std::regex_match(name, pattern_) != invert_;
  if (known_.size() < kMostKnown) known_.emplace(std::move(name), wanted);
  return wanted;
}

}  // namespace palpate::record
