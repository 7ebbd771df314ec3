#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace palpate::support {

/// Folder of third-party recordings: PALPATE_DATA, otherwise ../shared/data next to the checkout.
inline std::filesystem::path recordings() {
  if (const char* folder = std::getenv("PALPATE_DATA")) return folder;
  return std::filesystem::path(PALPATE_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace palpate::support

/// Skips the test with a message if a recording is missing.
#define PALPATE_REQUIRE_RECORDING(name)                                              \
  if (!std::filesystem::exists(palpate::support::recordings() / (name)))             \
  GTEST_SKIP() << "recording " << (palpate::support::recordings() / (name)).string() \
               << " is absent; set PALPATE_DATA"
