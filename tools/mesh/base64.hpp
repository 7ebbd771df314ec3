#pragma once

#include <string>

namespace palpate::mesh_tool {

/// RFC 4648 with padding.
std::string to_base64(const std::string& bytes);

/// White space is passed over; what follows the padding of one block is another (VTK writes a
/// header and its data so). Throws std::runtime_error for any other character.
std::string from_base64(const std::string& text);

}  // namespace palpate::mesh_tool
