#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate::math {

/// 64-bit FNV-1a hash of bytes: identifies content, does not protect against forgery.
class Fnv1a {
 public:
  Fnv1a& add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) {
      // The analyser loses track of an integer that is read byte by byte.
      // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
      hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
    }
    return *this;
  }
  Fnv1a& add(std::string_view text) { return add(text.data(), text.size()); }

  std::uint64_t value() const { return hash_; }
  /// The same bits as LCM's int64_t stores them.
  std::int64_t signed_value() const { return static_cast<std::int64_t>(hash_); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace palpate::math
