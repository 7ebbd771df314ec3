#include "tools/common/base64.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <utility>

namespace palpate::common {
namespace {

TEST(Base64, HasTheStandardsOwnExamples) {
  const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : examples) {
    EXPECT_EQ(to_base64(plain), coded);
    EXPECT_EQ(from_base64(coded), plain);
  }
  EXPECT_EQ(from_base64("Zg==\n Zm9v"), "ffoo");
  EXPECT_THROW(from_base64("Zg="), std::runtime_error);
  EXPECT_THROW(from_base64("Zg=a"), std::runtime_error);
  EXPECT_THROW(from_base64("Z*9v"), std::runtime_error);
  std::mt19937 random(1);
  for (int length = 0; length < 100; ++length) {
    std::string bytes(length, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    EXPECT_EQ(from_base64(to_base64(bytes)), bytes);
  }
}

}  // namespace
}  // namespace palpate::common
