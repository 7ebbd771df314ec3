#include "tools/log/type_table.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/lcmtypes/all_types.hpp"
#include "tests/unit/rt/bus/messages.hpp"
#include "tools/log/record.hpp"

namespace palpate::log {
namespace {

using bus::wire::encoded;

const TypeInfo* find(const std::string& name) {
  for (const TypeInfo& type : types())
    if (type.name == name) return &type;
  return nullptr;
}

TEST(TypeTable, HoldsEveryTypeWithTheFingerprintThatIsSent) {
  std::size_t count = 0;
  const auto check = [&count](const auto& message) {
    using Message = std::decay_t<decltype(message)>;
    const TypeInfo* type = find(Message::getTypeName());
    ASSERT_NE(type, nullptr) << Message::getTypeName();
    EXPECT_EQ(type->fingerprint, Message::getHash()) << type->name;
    ++count;
  };
  for_each_fixed_size_type(check);
  for_each_variable_size_type(check);
  EXPECT_EQ(count, types().size());
}

TEST(TypeTable, EveryTypeBeginsAlikeAndEveryFieldSaysItsUnit) {
  for (const TypeInfo& type : types()) {
    ASSERT_GT(type.fields.size(), 3u) << type.name;
    EXPECT_EQ(type.fields[0].name, "utime");
    EXPECT_EQ(type.fields[0].units, std::vector<std::string>{"us"});
    EXPECT_EQ(type.fields[1].name, "seq");
    EXPECT_EQ(type.fields[2].name, "session");
    std::set<std::string> names;
    for (const FieldInfo& field : type.fields) {
      EXPECT_TRUE(names.insert(field.name).second) << type.name << '.' << field.name;
      EXPECT_FALSE(field.units.empty() || field.units.front().empty())
          << type.name << '.' << field.name;
    }
  }
}

TEST(TypeTable, KnowsUnitsCountsAndConstants) {
  const TypeInfo& contacts = *find("contacts_t");
  const FieldInfo& wrench = contacts.fields[contacts.field("wrench")];
  EXPECT_EQ(wrench.sizes, (std::vector<int>{8, 6}));
  EXPECT_EQ(wrench.row_size(), 6);
  EXPECT_EQ(wrench.unit(2), "N");
  EXPECT_EQ(wrench.unit(9), "N m");  // of the second row
  EXPECT_EQ(wrench.count_field, contacts.field("count"));
  const TypeInfo& shape = *find("shape_t");
  EXPECT_EQ(shape.fields[shape.field("xyz")].length_field, shape.field("xyz_count"));
  const std::pair<std::string, std::int64_t> old{"STATUS_OLD", 1};
  EXPECT_EQ(shape.constants[1], old);
  EXPECT_EQ(shape.field("no such field"), -1);
}

TEST(Record, TakesEveryTypeApart) {
  const auto check = [](auto message) {
    message.utime = -123456789012345;
    message.seq = 77;
    message.session = 0x0123456789abcdef;
    std::vector<std::uint8_t> bytes = encoded(message);
    const TypeInfo* type = type_of(bytes.data(), static_cast<int>(bytes.size()));
    ASSERT_NE(type, nullptr);
    Record record(*type);
    ASSERT_TRUE(record.decode(bytes.data(), static_cast<int>(bytes.size()))) << type->name;
    EXPECT_EQ(record.utime(), message.utime);
    EXPECT_EQ(record.seq(), 77);
    EXPECT_EQ(record.hexadecimal(2, 0, 1), "0123456789abcdef");
    bytes.pop_back();
    EXPECT_FALSE(record.decode(bytes.data(), static_cast<int>(bytes.size()))) << type->name;
    bytes.resize(bytes.size() + 9);
    EXPECT_FALSE(record.decode(bytes.data(), static_cast<int>(bytes.size()))) << type->name;
  };
  for_each_fixed_size_type(check);
  for_each_variable_size_type(check);
}

TEST(Record, ReadsNumbersOfEachKind) {
  shape_t shape{};
  shape.xyz = {0.1F, -2.5F, 3e20F};
  shape.xyz_count = 3;
  std::vector<std::uint8_t> bytes = encoded(shape);
  Record record(*find("shape_t"));
  ASSERT_TRUE(record.decode(bytes.data(), static_cast<int>(bytes.size())));
  const int xyz = record.type().field("xyz");
  EXPECT_EQ(record.used(xyz), 3);
  EXPECT_EQ(record.number(xyz, 1), -2.5);
  std::string text;
  record.append_number(xyz, 0, text);
  EXPECT_EQ(text, "0.1");  // the shortest that is the same float

  health_t health{};
  health.input_count = 2;
  std::copy_n("FT_WRENCH", 9, health.input_name[0]);
  std::copy_n("IMU", 3, health.input_name[1]);
  health.lost[1] = 12;
  bytes = encoded(health);
  Record other(*find("health_t"));
  ASSERT_TRUE(other.decode(bytes.data(), static_cast<int>(bytes.size())));
  const int names = other.type().field("input_name"), lost = other.type().field("lost");
  EXPECT_EQ(other.texts(names), 2);
  EXPECT_EQ(other.text(names, 1), "IMU");
  EXPECT_EQ(other.used(lost), 2);
  EXPECT_EQ(other.size(lost), 16);
  EXPECT_EQ(other.integer(lost, 1), 12);
}

TEST(Record, LengthsThatLieAreNoMessage) {
  shape_t shape{};
  shape.xyz = {1, 2, 3};
  shape.xyz_count = 3;
  std::vector<std::uint8_t> bytes = encoded(shape);
  Record record(*find("shape_t"));
  const std::size_t count_at = 8 + 8 + 4 + 8 + 8 + 4 + 4 + 2 + 2 + 4 + 4;
  ASSERT_EQ(bytes[count_at + 3], 3);
  for (const int lie : {0, 2, 4, 0x7f, 0xff}) {
    bytes[count_at] = static_cast<std::uint8_t>(lie > 4 ? lie : 0);
    bytes[count_at + 3] = static_cast<std::uint8_t>(lie);
    EXPECT_FALSE(record.decode(bytes.data(), static_cast<int>(bytes.size()))) << lie;
  }
}

TEST(Record, CountsBeyondTheArrayAreCutToIt) {
  contacts_t contacts{};
  for (const auto& [stated, used] : {std::pair{-5, 0}, {3, 3}, {1000, 8}}) {
    contacts.count = stated;
    const std::vector<std::uint8_t> bytes = encoded(contacts);
    Record record(*find("contacts_t"));
    ASSERT_TRUE(record.decode(bytes.data(), static_cast<int>(bytes.size())));
    EXPECT_EQ(record.used(record.type().field("wrench")), 6 * used);
  }
}

}  // namespace
}  // namespace palpate::log
