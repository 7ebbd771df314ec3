#include "rt/config/declarations.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"

namespace palpate::config {
namespace {

TEST(Declarations, DescribeWhatAGetterReads) {
  const Node root = Node::from_text("control: {gain: 2, law: b}", "t.yaml");
  DeclarationList list;
  const Node control = root.child({"control", "", "how it is steered"});
  control.number({"gain", "1/s", "share of the error"}, {0.5, 3}, 1);
  control.choice({"law", "", "which"}, {"a", "b"}, "a");
  control.integer("count", {0, 5}, 3);
  control.pose({"frame", "m", "X_AB"});
  ASSERT_EQ(list.all().size(), 5U);
  const Declaration& gain = list.all()[1];
  EXPECT_EQ(gain.document, "t.yaml");
  EXPECT_EQ(gain.path, "control");
  EXPECT_EQ(gain.name, "gain");
  EXPECT_EQ(gain.type, "number");
  EXPECT_EQ(gain.unit, "1/s");
  EXPECT_EQ(gain.meaning, "share of the error");
  EXPECT_EQ(gain.allowed, "0.5 to 3");
  EXPECT_EQ(gain.fallback, "1");
  EXPECT_TRUE(gain.present);
  EXPECT_FALSE(gain.required);
  EXPECT_TRUE(list.all()[0].required);
  EXPECT_EQ(list.all()[2].value, "b");
  EXPECT_EQ(list.all()[2].allowed, "a, b");
  EXPECT_EQ(list.all()[3].type, "whole number");
  EXPECT_EQ(list.all()[3].fallback, "3");
  EXPECT_EQ(list.all()[4].name, "frame") << "and nothing of its parts";
}

TEST(Declarations, AKeyIsListedOnceWithTheMeaningThatOneOfItsReadersGives) {
  const Node root = Node::from_text("a: 1", "t.yaml");
  DeclarationList list;
  root.number("a", {0, 2}, 0);
  root.number({"a", "m", "length"}, {0, 2}, 0);
  ASSERT_EQ(list.all().size(), 1U);
  EXPECT_EQ(list.all()[0].meaning, "length");
  EXPECT_EQ(list.all()[0].unit, "m");
}

TEST(Declarations, ATextThatIsThenAChoiceIsAChoice) {
  const Node root = Node::from_text("component: b", "t.yaml");
  DeclarationList list;
  root.text("component");
  root.choice({"component", "", "which"}, {"a", "b"});
  ASSERT_EQ(list.all().size(), 1U);
  EXPECT_EQ(list.all()[0].type, "one of");
  EXPECT_EQ(list.all()[0].allowed, "a, b");
  EXPECT_EQ(list.all()[0].value, "b");
  EXPECT_EQ(list.all()[0].meaning, "which");
}

TEST(Declarations, AreListedOnlyWithAListener) {
  const Node root = Node::from_text("a: 1", "t.yaml");
  root.number({"a", "m", "length"}, {0, 2});
  DeclarationList list;
  EXPECT_TRUE(list.all().empty());
  EXPECT_THROW(DeclarationList(), std::logic_error);
}

TEST(Declarations, AMissingKeyIsDeclaredBeforeItIsAnError) {
  const Node root = Node::from_text("{}", "t.yaml");
  DeclarationList list;
  EXPECT_THROW(root.number({"a", "m", "length"}, {0, 2}), Error);
  ASSERT_EQ(list.all().size(), 1U);
  EXPECT_TRUE(list.all()[0].required);
  EXPECT_FALSE(list.all()[0].present);
}

}  // namespace
}  // namespace palpate::config
