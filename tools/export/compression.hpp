#pragma once

#include <string>
#include <string_view>

namespace palpate::exporting {

/// Compression of the chunks of an MCAP file.
enum class Compression { kNone, kLz4, kZstd };

/// Name in MCAP's registry: "", "lz4", "zstd".
const char* name_of(Compression compression);

/// A complete frame of the given kind. Throws std::runtime_error.
std::string compress(Compression compression, std::string_view bytes);

}  // namespace palpate::exporting
