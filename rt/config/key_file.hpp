#pragma once

#include <optional>

#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"

namespace palpate::config {

/// Section `access: {key_file: FILE}` of a configuration or a scene: key with which commands must
/// be signed; empty if the section is absent, and commands are then accepted without
/// authentication. Throws Error.
std::optional<bus::Key> read_key(const Node& root);

}  // namespace palpate::config
