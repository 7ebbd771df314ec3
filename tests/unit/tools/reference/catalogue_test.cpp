#include "tools/reference/catalogue.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "rt/config/node.hpp"
#include "tools/reference/markdown.hpp"

namespace palpate::reference {
namespace {

/// A slot whose component b has its own gain, and a key that may be absent.
Declarations read(const std::string& text) {
  const config::Node root = config::Node::from_text(text, "t.yaml");
  config::DeclarationList list;
  for (const config::Node& item : root.list({"parts", "", "of it"})) {
    const std::string name = item.choice({"component", "", "which"}, {"a", "b"});
    item.number({"speed", "m/s", "of it"}, {0, 1}, name == "a" ? 0.25 : 0.5);
    if (name == "b") item.number({"gain", "1/s", "of b|c"}, {0, 9});
    if (item.has("limit")) item.number({"limit", "N", "of its force"}, {0, 9});
  }
  return list.all();
}

const Parameter& parameter(const std::vector<Section>& sections, const std::string& path,
                           const std::string& name) {
  static const Parameter kNone;
  for (const Section& section : sections)
    for (const Parameter& known : section.parameters)
      if (section.path == path && known.name == name) return known;
  ADD_FAILURE() << path << "." << name << " is not in the catalogue";
  return kNone;
}

TEST(Catalogue, StatesWithWhichChoiceAKeyIsRead) {
  const std::vector<Section> sections =
      merge({read("parts: [{component: a}, {component: b, gain: 1}]"),
             read("parts: [{component: a, limit: 1}]")});
  ASSERT_EQ(sections.size(), 2U);
  EXPECT_EQ(sections[1].path, "parts[]");
  const Parameter& gain = parameter(sections, "parts[]", "gain");
  EXPECT_TRUE(gain.required);
  ASSERT_EQ(gain.only_with.count("component"), 1U);
  EXPECT_EQ(gain.only_with.at("component"), std::set<std::string>{"b"});
  const Parameter& speed = parameter(sections, "parts[]", "speed");
  EXPECT_FALSE(speed.required);
  EXPECT_TRUE(speed.only_with.empty());
  EXPECT_EQ(speed.defaults, (std::vector<std::string>{"0.25", "0.5"}));
  EXPECT_FALSE(parameter(sections, "parts[]", "limit").required) << "it may be absent";
  EXPECT_TRUE(undescribed(sections).empty());
}

TEST(Catalogue, NamesKeysWithoutDescription) {
  const config::Node root = config::Node::from_text("a: {b: 1}", "t.yaml");
  Declarations declarations;
  {
    config::DeclarationList list;
    root.child({"a", "", "section"}).number("b", {0, 2});
    declarations = list.all();
  }
  EXPECT_EQ(undescribed(merge({declarations})), std::vector<std::string>{"a.b"});
}

TEST(Catalogue, MarkdownKeepsItsTablesWhole) {
  std::ostringstream text;
  write_markdown(text, merge({read("parts: [{component: b, gain: 1}]")}), 3);
  EXPECT_NE(text.str().find("### `parts[]`"), std::string::npos);
  EXPECT_NE(text.str().find("| `gain` | number | 1/s | **required** | 0 to 9 | of b\\|c |"),
            std::string::npos)
      << text.str();
}

}  // namespace
}  // namespace palpate::reference
