#include "rt/config/bus_keys.hpp"

#include <algorithm>
#include <palpate/channels.hpp>
#include <vector>

namespace palpate::config {
namespace {

/// Every channel, with the numbers of arms and fingers.
std::vector<std::string> all_channels() {
  std::vector<std::string> names;
  for (const channel::Channel& one : channel::kAll) {
    const std::string name(one.name);
    if (one.number != channel::Number::kFinger) names.push_back(name);
    if (one.number == channel::Number::kArm) names.push_back(name + "_1");
    for (int finger = 0; one.number == channel::Number::kFinger && finger < 5; ++finger)
      names.push_back(name + "_" + std::to_string(finger));
  }
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

bus::ChannelNames read_channel_names(const Node& bus) {
  const Node node = bus.child_or_empty(
      {"channels", "", "names that channels have on the bus in place of palpate's own"});
  const std::vector<std::string> known = all_channels();
  palpate::bus::ChannelNames names;
  for (const std::string& own : node.keys()) {
    if (std::find(known.begin(), known.end(), own) == known.end())
      node.fail(own, "is no channel of palpate; allowed: " + joined(known));
    const std::string name =
        node.text(Key::named_by_user(own, "CHANNEL", "", "name of this channel on the bus"));
    if (!palpate::bus::is_channel_name(name))
      node.fail(own, name + "; allowed: 1 to 63 of the characters A-Z, 0-9 and _");
    names[own] = name;
  }
  // Also of different buses: one URL may serve for all.
  const auto on_bus = [&names](const std::string& own) {
    const auto found = names.find(own);
    return found == names.end() ? own : found->second;
  };
  for (const auto& [own, name] : names)
    for (const std::string& other : known)
      if (other != own && on_bus(other) == name)
        node.fail(own, name + " is the name of " + other + "; allowed: a name of its own");
  return names;
}

int read_largest_message(const Node& bus) {
  return bus.integer(
      {"largest_message", "bytes",
       "largest message that is received in several fragments, as LCM on macOS sends those above "
       "1.4 kB; 0: none"},
      {0, palpate::bus::kLargestEncodedSize}, palpate::bus::kLargestEncodedSize);
}

}  // namespace palpate::config
