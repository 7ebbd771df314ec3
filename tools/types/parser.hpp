#pragma once

#include <string>
#include <vector>

#include "tools/types/description.hpp"

namespace palpate::types {

/// What one .lcm file describes; members of other types are not resolved yet (kStruct without
/// content), fingerprints not computed.
struct Description {
  std::vector<Struct> structs;
  std::vector<Enumeration> enumerations;
};

/// Parses the text of an .lcm file by the rules of lcm-gen (packages, structs, constants,
/// enumerations, arrays of fixed and variable size in any number of dimensions, both kinds of
/// comments); constants as array sizes, as in LCM 1.5, included. Throws std::runtime_error
/// "FILE:LINE: what is wrong"; `file` is only for messages.
Description parse(const std::string& text, const std::string& file);

/// Whether `name` is a type of LCM itself; then `kind` is set.
bool is_primitive(const std::string& name, Kind& kind);

}  // namespace palpate::types
