// Descriptions of LCM types, and messages of them: the text of an .lcm file, a zero, and a message,
// whose fingerprint is put in its place so that damage reaches the values.

#include <algorithm>
#include <stdexcept>

#include "tests/fuzz/target.hpp"
#include "tools/types/leaves.hpp"
#include "tools/types/type_set.hpp"

namespace palpate::fuzz {

std::vector<std::string> seeds() {
  const std::string zeros(100, '\0');
  return {
      std::string("package a.b; // words\nenum e { A = 1, B }\nstruct p { const int32_t N = 2; "
                  "float x[N][3]; e kind; }\n/* more\n * words */ struct q { int8_t n; p many[n]; "
                  "string s; byte raw[n]; q within[n]; }") +
          zeros,
      std::string("struct empty { }\nstruct a { int32_t n, m; empty e[n][m]; double x[m]; "
                  "boolean b[4]; string names[n]; }") +
          std::string("\0\0\0\0\2\0\0\0\1", 9) + zeros};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::uint8_t* const end = data + size;
  const std::uint8_t* const zero = std::find(data, end, 0);
  try {
    const types::TypeSet types(std::string(data, zero), "fuzz.lcm");
    for (const auto& type : types.structs()) {
      std::vector<std::uint8_t> message;
      for (int i = 7; i >= 0; --i)
        message.push_back(static_cast<std::uint8_t>(type->fingerprint >> (8 * i)));
      message.insert(message.end(), zero == end ? end : zero + 1, end);
      const int length = static_cast<int>(message.size());
      std::size_t bytes = 8;
      const bool fits =
          types::each_leaf(*type, message.data(), length, [&bytes](const types::Leaf& leaf) {
            const std::size_t of_text = leaf.text().size() + 5;
            bytes += leaf.what() == types::Leaf::What::kText    ? of_text
                     : leaf.what() == types::Leaf::What::kBytes ? leaf.text().size()
                                                                : 0;
            if (leaf.is_number())
              bytes += static_cast<std::size_t>(types::size_of(leaf.member().kind));
            fuzz::require(!leaf.path().empty(), "a leaf has a path");
          });
      fuzz::require(!fits || bytes == message.size(), "each byte belongs to one value");
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
