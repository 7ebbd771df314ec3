#include "tools/export/json_schema.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <palpate/contacts_t.hpp>
#include <palpate/health_t.hpp>

#include "tests/unit/lcmtypes/all_types.hpp"

namespace palpate::exporting {
namespace {

template <class Message>
nlohmann::json json_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  log::Record record(*log::type_of(bytes.data(), static_cast<int>(bytes.size())));
  EXPECT_TRUE(record.decode(bytes.data(), static_cast<int>(bytes.size())));
  std::string text;
  append_json(record, text);
  return nlohmann::json::parse(text);
}

TEST(Json, EveryTypeHasExactlyTheFieldsOfItsSchema) {
  const auto check = [](const auto& message) {
    const nlohmann::json json = json_of(message);
    const log::TypeInfo* type = nullptr;
    for (const log::TypeInfo& info : log::types())
      if (info.name == std::decay_t<decltype(message)>::getTypeName()) type = &info;
    ASSERT_NE(type, nullptr);
    const auto schema = json_schema(*type);
    EXPECT_EQ(schema["properties"].size(), json.size()) << type->name;
    for (const auto& [name, property] : schema["properties"].items())
      EXPECT_TRUE(json.contains(name)) << type->name << '.' << name;
  };
  for_each_fixed_size_type(check);
  for_each_variable_size_type(check);
}

TEST(Json, NumbersTextsAndArraysInUse) {
  contacts_t contacts{};
  contacts.count = 2;
  contacts.wrench[1][5] = 0.1;
  contacts.deviation[0] = std::numeric_limits<double>::quiet_NaN();
  contacts.session = 0x1234;
  const nlohmann::json json = json_of(contacts);
  EXPECT_EQ(json["session"],
            "0000000000001234");  // 64 bits exceed JavaScript's numbers
  EXPECT_EQ(json["wrench"].size(), 2u);
  EXPECT_EQ(json["wrench"][1]["values"][5], 0.1);
  EXPECT_TRUE(json["deviation"][0].is_null());

  health_t health{};
  health.input_count = 1;
  std::copy_n("IMU", 3, health.input_name[0]);
  std::copy_n("\"\\\n\xff\xc3\xa9", 6, health.reason);
  const nlohmann::json other = json_of(health);
  EXPECT_EQ(other["input_name"], nlohmann::json({"IMU"}));
  EXPECT_EQ(other["reason"], "\"\\\n?\xc3\xa9");
}

}  // namespace
}  // namespace palpate::exporting
