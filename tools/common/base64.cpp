#include "tools/common/base64.hpp"

#include <sodium.h>

#include <stdexcept>

namespace palpate::common {

std::string to_base64(const void* bytes, std::size_t size) {
  constexpr int kVariant = sodium_base64_VARIANT_ORIGINAL;
  std::string text(sodium_base64_encoded_len(size, kVariant), '\0');
  sodium_bin2base64(text.data(), text.size(), static_cast<const unsigned char*>(bytes), size,
                    kVariant);
  text.pop_back();  // its terminating zero
  return text;
}

std::string to_base64(const std::string& bytes) { return to_base64(bytes.data(), bytes.size()); }

std::string from_base64(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n\f\v";
  std::string bytes(3 * (text.size() / 4 + 1), '\0');
  std::size_t used = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    std::size_t decoded = 0;
    const char* stopped = nullptr;
    auto* const into = reinterpret_cast<unsigned char*>(bytes.data() + used);
    const int code =
        sodium_base642bin(into, bytes.size() - used, at, static_cast<std::size_t>(end - at),
                          kBlanks, &decoded, &stopped, sodium_base64_VARIANT_ORIGINAL);
    if (code != 0 || stopped == at)
      throw std::runtime_error(
          "invalid base64 at character " +
          std::to_string((stopped == nullptr ? at : stopped) - text.data() + 1));
    used += decoded;
    at = stopped;
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace palpate::common
