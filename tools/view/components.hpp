#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::view {

/// One choice within a slot: its key in a configuration, and its allowed values.
struct Choice {
  std::string key;  // component; provider and law of the controller
  std::vector<std::string> names;
};

/// A slot of the pipeline as defined in rt/registry.
struct SlotChoices {
  std::string slot;
  bool has_instances = false;  // a list of named ones
  std::vector<Choice> choices;
};

/// All slots whose components can be replaced.
const std::vector<SlotChoices>& slot_choices();

/// Contents of a slot in a configuration.
struct Configured {
  std::string slot, instance;
  std::vector<std::pair<std::string, std::string>> chosen;  // key and name
};

/// In the order of the pipeline. Throws config::Error.
std::vector<Configured> read_configured(const config::Node& root);

}  // namespace palpate::view
