#pragma once

#include <cstddef>
#include <string>

namespace palpate::common {

/// Base64 of `size` bytes, with padding, without line breaks (RFC 4648).
std::string to_base64(const void* bytes, std::size_t size);
std::string to_base64(const std::string& bytes);

/// Bytes of base64 text; blanks are passed over, and padded blocks may follow each other, as in
/// VTK's files. Throws std::runtime_error for anything else.
std::string from_base64(const std::string& text);

}  // namespace palpate::common
