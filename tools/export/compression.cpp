#include "tools/export/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <stdexcept>

namespace palpate::exporting {
namespace {

constexpr int kZstdLevel = 3;

std::string lz4_frame(std::string_view bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.contentSize = bytes.size();
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size)) throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(size));
  packed.resize(size);
  return packed;
}

std::string zstd_frame(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

}  // namespace

const char* name_of(Compression compression) {
  switch (compression) {
    case Compression::kLz4:
      return "lz4";
    case Compression::kZstd:
      return "zstd";
    case Compression::kNone:
      break;
  }
  return "";
}

std::string compress(Compression compression, std::string_view bytes) {
  switch (compression) {
    case Compression::kLz4:
      return lz4_frame(bytes);
    case Compression::kZstd:
      return zstd_frame(bytes);
    case Compression::kNone:
      break;
  }
  return std::string(bytes);
}

}  // namespace palpate::exporting
