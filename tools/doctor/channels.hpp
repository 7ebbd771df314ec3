#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::doctor {

/// A channel on which palpated receives or publishes.
struct Channel {
  std::string name;
  std::string type;  // of lcmtypes/
  std::string url;
  bool is_heard = false;  // otherwise palpated publishes on it
  double rate = 0;  // messages/s that it publishes; 0: on change, or received at the sender's rate
  std::string about;  // first line of the type's comment
};

/// All channels of a configuration of palpated, inputs first, before it runs: it is built as the
/// daemon builds it and runs for some seconds of virtual time, without other participants, on a bus
/// in memory. Throws config::Error.
std::vector<Channel> channels_of(const std::string& path,
                                 const std::vector<std::string>& overrides);

void print(const std::vector<Channel>& channels, std::ostream& out);
nlohmann::json to_json(const std::vector<Channel>& channels);

}  // namespace palpate::doctor
