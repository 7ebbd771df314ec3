#include "tools/record/message_types.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/shape_t.hpp>
#include <set>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::record {
namespace {

using bus::wire::encoded;

shape_t shape_of(int nodes) {
  shape_t shape{};
  shape.node_count = nodes;
  shape.xyz_count = 3 * nodes;
  shape.xyz.resize(static_cast<std::size_t>(shape.xyz_count));
  return shape;
}

TEST(MessageTypes, AreThoseThatAreDefined) {
  std::set<std::string> defined, known;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(PALPATE_SOURCE_DIR) + "/lcmtypes")) {
    if (entry.path().extension() == ".lcm") defined.insert(entry.path().stem().string());
  }
  for (const MessageType& type : message_types()) known.insert(type.name);
  EXPECT_EQ(known, defined);
}

TEST(MessageTypes, AreRecognisedByFingerprintAndSize) {
  ft_wrench_t message{};
  message.utime = -5;
  message.seq = 77;
  message.session = 0x123456789abcdef;
  auto data = encoded(message);
  const int size = static_cast<int>(data.size());
  const MessageType* type = type_of(data.data(), size);
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->name, "ft_wrench_t");
  EXPECT_TRUE(type->fits(data.data(), size));
  EXPECT_FALSE(type->fits(data.data(), size - 1));
  const MessageHeader header = header_of(data.data());
  EXPECT_EQ(header.utime, -5);
  EXPECT_EQ(header.seq, 77);
  EXPECT_EQ(header.session, 0x123456789abcdef);
  data[0] ^= 1;
  EXPECT_EQ(type_of(data.data(), size), nullptr);
  EXPECT_EQ(type_of(data.data(), 7), nullptr) << "shorter than any fingerprint";
}

TEST(MessageTypes, ArraysMustBeAsLongAsTheySay) {
  auto data = encoded(shape_of(10));
  const int size = static_cast<int>(data.size());
  const MessageType* type = type_of(data.data(), size);
  ASSERT_NE(type, nullptr);
  EXPECT_TRUE(type->fits(data.data(), size));
  EXPECT_FALSE(type->fits(data.data(), size - 4));
  constexpr std::size_t kCountAt = 56;
  data[kCountAt] = 0xff;  // negative
  EXPECT_FALSE(type->fits(data.data(), size));
  data[kCountAt] = 0x20;  // whose size in bytes overflows 32 bits to a small one
  EXPECT_FALSE(type->fits(data.data(), size));
}

}  // namespace
}  // namespace palpate::record
