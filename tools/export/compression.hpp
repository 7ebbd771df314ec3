#pragma once

#include <string>
#include <string_view>

namespace palpate::exporting {

/// How the chunks of an MCAP file are packed.
enum class Compression { kNone, kLz4, kZstd };

/// As MCAP's registry calls it: "", "lz4", "zstd".
const char* name_of(Compression compression);

/// A whole frame of its kind. Throws std::runtime_error.
std::string compress(Compression compression, std::string_view bytes);

}  // namespace palpate::exporting
