#pragma once

#include <optional>

#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"

namespace palpate::config {

/// Section `access: {key_file: FILE}` of a configuration or a scene: the key that commands must be
/// sealed with; none where the section is absent, and then anybody may command. Throws Error.
std::optional<bus::Key> read_key(const Node& root);

}  // namespace palpate::config
