#include "tools/types/decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tools/log/record.hpp"
#include "tools/types/leaves.hpp"
#include "tools/types/message_values.hpp"
#include "tools/types/type_set.hpp"

namespace palpate::types {
namespace {

using ::testing::ElementsAre;

/// A message: the fingerprint, and numbers of any width.
class Bytes {
 public:
  explicit Bytes(std::int64_t fingerprint) { add(8, fingerprint); }
  Bytes& add(int width, std::int64_t value) {
    for (int i = width - 1; i >= 0; --i)
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  Bytes& add(const std::string& text) {
    add(4, static_cast<std::int64_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return add(1, 0);
  }
  const std::uint8_t* data() const { return bytes_.data(); }
  int size() const { return static_cast<int>(bytes_.size()); }

 private:
  std::vector<std::uint8_t> bytes_;
};

std::vector<std::string> lines_of(const Struct& type, const Bytes& bytes) {
  std::vector<std::string> lines;
  const bool fit = each_leaf(type, bytes.data(), bytes.size(), [&lines](const Leaf& leaf) {
    lines.push_back(leaf.path() + " ");
    leaf.append_to(lines.back());
  });
  if (!fit) lines.emplace_back("malformed");
  return lines;
}

TEST(Decoder, PassesOnEveryValueWithItsPath) {
  const TypeSet types(
      "struct point { float x; int16_t count; string names[count]; }\n"
      "struct all { int8_t n; point p[n][1]; boolean on; byte raw[n]; int64_t last; }",
      "a.lcm");
  const Struct& type = *types.find("all");
  Bytes bytes(type.fingerprint);
  bytes.add(1, 2);                                 // n
  bytes.add(4, 0x3dcccccd).add(2, 1).add("a\"b");  // 0.1f
  bytes.add(4, 0x7fc00000).add(2, 0);              // not a number
  bytes.add(1, 7).add(1, 0xab).add(1, 0xcd).add(8, -5);
  EXPECT_THAT(lines_of(type, bytes),
              ElementsAre("n 2", "p[0][0].x 0.1", "p[0][0].count 1", "p[0][0].names[0] a\"b",
                          "p[1][0].x nan", "p[1][0].count 0", "on 1", "raw abcd", "last -5"));
  bytes.add(1, 0);
  EXPECT_THAT(lines_of(type, bytes), ElementsAre("malformed"));
}

// Of every type of fixed size: any bytes are a message, and the table that is generated from
// lcmtypes/ decodes them independently.
TEST(Decoder, AgreesWithTheGeneratedTable) {
  std::mt19937 random(1);
  int compared = 0;
  for (const log::TypeInfo& info : log::types()) {
    std::int64_t size = 8;
    bool is_fixed = true;
    for (const log::FieldInfo& field : info.fields) {
      std::int64_t count = 1;
      for (const int dimension : field.sizes) count *= dimension;
      is_fixed = is_fixed && field.length_field < 0;
      size += count * log::size_of(field.primitive);
    }
    if (!is_fixed) continue;
    const Struct& type = *own_types().find("palpate." + info.name);
    for (int round = 0; round < 20; ++round) {
      Bytes bytes(type.fingerprint);
      while (bytes.size() < size) bytes.add(1, static_cast<std::int64_t>(random() & 0xff));
      log::Record record(info);
      ASSERT_TRUE(record.decode(bytes.data(), bytes.size()));
      std::size_t field = 0;
      int index = 0;
      ASSERT_TRUE(each_leaf(type, bytes.data(), bytes.size(), [&](const Leaf& leaf) {
        while (index == record.size(static_cast<int>(field))) {
          ++field;
          index = 0;
        }
        const int f = static_cast<int>(field);
        std::string expected, found;
        if (leaf.what() == Leaf::What::kBytes) {
          const int count = static_cast<int>(leaf.text().size());
          expected = record.hexadecimal(f, index, count);
          leaf.append_to(found, count);
          index += count;
        } else {
          record.append_number(f, index++, expected);
          leaf.append_to(found);
          if (type.members[field].kind == Kind::kBoolean && expected != "0") expected = "1";
        }
        ASSERT_EQ(found, expected) << info.name << " " << leaf.path();
        ++compared;
      }));
      EXPECT_FALSE(fits(type, bytes.data(), bytes.size() - 1));
    }
  }
  EXPECT_GT(compared, 20'000);
}

TEST(Decoder, EndsWithinBoundsForAnySizes) {
  const TypeSet types(
      "struct empty { }\n"
      "struct chain { int32_t n; chain next[n]; }\n"
      "struct wide { int32_t n, m; double x[n]; empty e[m]; empty ee[n][m]; string s[n]; }",
      "a.lcm");
  const Struct& wide = *types.find("wide");
  const auto wide_of = [&wide](std::int64_t n, std::int64_t m) {
    return Bytes(wide.fingerprint).add(4, n).add(4, m);
  };
  const auto is_sound = [](const Struct& type, const Bytes& bytes) {
    return fits(type, bytes.data(), bytes.size());
  };
  EXPECT_TRUE(is_sound(wide, wide_of(0, 1000)));
  EXPECT_FALSE(is_sound(wide, wide_of(0x7fffffff, 0)));
  EXPECT_FALSE(is_sound(wide, wide_of(0, 0x7fffffff)));  // of elements without bytes
  EXPECT_FALSE(is_sound(wide, wide_of(-1, 0)));
  const Struct& chain = *types.find("chain");
  Bytes deep(chain.fingerprint);
  for (int i = 0; i < 60; ++i) deep.add(4, 1);
  EXPECT_TRUE(is_sound(chain, Bytes(deep).add(4, 0)));
  for (int i = 0; i < 100'000; ++i) deep.add(4, 1);
  EXPECT_FALSE(is_sound(chain, deep.add(4, 0)));
}

TEST(Decoder, StringsEndWithinTheMessageWithAZero) {
  const TypeSet types("struct a { string s; }", "a.lcm");
  const Struct& type = *types.find("a");
  EXPECT_THAT(lines_of(type, Bytes(type.fingerprint).add("")), ElementsAre("s "));
  EXPECT_THAT(lines_of(type, Bytes(type.fingerprint).add(4, 0)), ElementsAre("malformed"));
  EXPECT_THAT(lines_of(type, Bytes(type.fingerprint).add(4, 2).add(1, 'a')),
              ElementsAre("malformed"));
  EXPECT_THAT(lines_of(type, Bytes(type.fingerprint).add(4, 1).add(1, 'a')),
              ElementsAre("malformed"));
  EXPECT_THAT(lines_of(type, Bytes(type.fingerprint).add(4, -1).add(1, 0)),
              ElementsAre("malformed"));
}

TEST(MessageValues, KeepsTheLastMessageAndCountsMalformedOnes) {
  const TypeSet types("struct a { int32_t n; double x[n]; byte name[4]; }", "a.lcm");
  const Struct& type = *types.find("a");
  MessageValues values(types);
  Bytes good(type.fingerprint), bad(type.fingerprint);
  good.add(4, 10);
  for (int i = 0; i < 10; ++i) good.add(8, 0);
  good.add(4, 'b' << 24 | 'a' << 16);
  bad.add(4, 1);
  EXPECT_TRUE(values.take(0, "A", bad.data(), bad.size(), 1));
  EXPECT_TRUE(values.take(0, "A", good.data(), good.size(), 2));
  EXPECT_FALSE(values.take(0, "B", "unknown!", 8, 2));
  const std::vector<ShownMessage> shown = values.shown(11);
  ASSERT_EQ(shown.size(), 1u);
  EXPECT_EQ(shown[0].messages, 2);
  EXPECT_EQ(shown[0].malformed, 1);
  EXPECT_EQ(shown[0].left_out, 1);
  EXPECT_EQ(shown[0].time_us, 2);
  const std::size_t end = line_end(shown[0].values, 1);
  EXPECT_EQ(line_of(shown[0].values, 1, end).first, "x[0:8]");
  EXPECT_EQ(line_of(shown[0].values, end, line_end(shown[0].values, end)).first, "x[8:10]");
  EXPECT_EQ(values.shown(12)[0].values.back().text, "ba");
}

}  // namespace
}  // namespace palpate::types
