#include "tools/reference/schema.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rt/config/node.hpp"

namespace palpate::reference {
namespace {

using Json = nlohmann::json;

Declarations read_parts(const std::string& text) {
  const config::Node root = config::Node::from_text(text, "t.yaml");
  config::DeclarationList list;
  for (const config::Node& item : root.list({"parts", "", "Parts"})) {
    const std::string name =
        item.component({"component", "", "Kind"}, {{"a", "One"}, {"b", "Two"}});
    item.number({"speed", "m/s", "Speed"}, {0, 1}, 0.25);
    if (name == "b") item.number({"gain", "1/s", "Gain"}, {0, 9});
  }
  return list.all();
}

class Schema : public ::testing::Test {
 protected:
  const Json schema_ = Json::parse(write_schema(
      {"Test", all_sections({read_parts("parts: [{component: a}, {component: b, gain: 1}]")})}));
  const Json part_ = schema_["definitions"]["complete.parts.item"];
};

TEST_F(Schema, TypesRangesDefaultsAndDescriptionsAreThoseOfTheDeclaration) {
  const Json speed = part_["properties"]["speed"];
  EXPECT_EQ(speed["type"], "number");
  EXPECT_EQ(speed["minimum"], 0);
  EXPECT_EQ(speed["maximum"], 1);
  EXPECT_EQ(speed["default"], 0.25);
  EXPECT_EQ(speed["description"], "Speed [m/s]");
  EXPECT_EQ(part_["properties"]["component"]["enum"], Json::array({"a", "b"}));
  EXPECT_EQ(part_["properties"]["component"]["enumDescriptions"], Json::array({"One", "Two"}));
  EXPECT_EQ(part_["additionalProperties"], false);
}

TEST_F(Schema, AKeyOfOneComponentIsAllowedWithThatComponentOnly) {
  ASSERT_EQ(part_["allOf"].size(), 2U);
  const Json &a = part_["allOf"][0], &b = part_["allOf"][1];
  EXPECT_EQ(a["if"]["properties"]["component"]["const"], "a");
  EXPECT_EQ(a["then"]["properties"]["gain"], false);
  EXPECT_EQ(b["then"]["properties"]["gain"]["maximum"], 9);
  EXPECT_EQ(b["then"]["required"], Json::array({"gain"}));
}

TEST_F(Schema, ADocumentWithABaseMayOmitAndRemoveKeys) {
  const Json partial = schema_["definitions"]["partial"];
  EXPECT_EQ(schema_["then"]["$ref"], "#/definitions/partial");
  EXPECT_FALSE(partial.contains("required"));
  EXPECT_EQ(partial["properties"]["parts"]["type"], Json::array({"array", "null"}));
  EXPECT_TRUE(partial["properties"].contains("base"));
}

}  // namespace
}  // namespace palpate::reference
