#pragma once

#include <string>

namespace palpate::mesh_tool {

/// RFC 4648 with padding.
std::string to_base64(const std::string& bytes);

/// White space is ignored; after the padding of a block another one may follow (VTK writes header
/// and data that way). Throws std::runtime_error for any other character.
std::string from_base64(const std::string& text);

}  // namespace palpate::mesh_tool
