#include "rt/config/node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/rt/config/error_of.hpp"

namespace palpate::config {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Node, ReadsEveryKind) {
  const Node node = Node::from_text(R"(
rate: 1e3
count: 7
on: true
name: bar
quoted: "12"
list: [1, -2.5, +3]
points: [[0, 0, 0], [1, 2, 3]]
names: [one, "two, too"]
nested: {deep: {value: -0.5}}
items: [{a: 1}, {a: 2}]
)");
  EXPECT_EQ(node.number("rate", {0, 2000}), 1000);
  EXPECT_EQ(node.integer("count", {0, 10}), 7);
  EXPECT_TRUE(node.flag("on", false));
  EXPECT_EQ(node.text("name"), "bar");
  EXPECT_EQ(node.text("quoted"), "12");
  EXPECT_EQ(node.choice("name", {"foo", "bar"}), "bar");
  EXPECT_THAT(node.numbers("list", 3), ElementsAre(1, -2.5, 3));
  EXPECT_THAT(node.numbers("list", -1), ElementsAre(1, -2.5, 3));
  EXPECT_EQ(node.vector3("list"), Eigen::Vector3d(1, -2.5, 3));
  EXPECT_EQ(node.points("points")[1], Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(node.texts("names"), ElementsAre("one", "two, too"));
  EXPECT_EQ(node.child("nested").child("deep").number("value", {}), -0.5);
  const std::vector<Node> items = node.list("items");
  ASSERT_EQ(items.size(), 2u);
  EXPECT_EQ(items[0].integer("a", {}), 1);
  EXPECT_EQ(items[1].integer("a", {}), 2);
  EXPECT_TRUE(node.has("count"));
  EXPECT_FALSE(node.has("absent"));
  EXPECT_THAT(node.child("nested").keys(), ElementsAre("deep"));
  EXPECT_NO_THROW(node.check_all_used());
}

TEST(Node, DefaultsStandForAbsentKeys) {
  const Node node = Node::from_text("");
  EXPECT_EQ(node.number("a", {0, 1}, 0.5), 0.5);
  EXPECT_EQ(node.integer("b", {0, 1}, 1), 1);
  EXPECT_FALSE(node.flag("c", false));
  EXPECT_EQ(node.text("d", "x"), "x");
  EXPECT_EQ(node.choice("e", {"x", "y"}, "y"), "y");
  EXPECT_EQ(node.vector3("f", {}, {1, 2, 3}), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(node.list("g").empty());
  EXPECT_TRUE(node.child_or_empty("h").keys().empty());
  EXPECT_EQ(node.child_or_empty("h").child_or_empty("i").number("j", {}, 4), 4);
  EXPECT_EQ(node.pose("k").matrix(), Eigen::Matrix4d::Identity());
}

TEST(Node, ErrorsNameFileLineKeyAndWhatIsAllowed) {
  const Node node = Node::from_text(R"(robot:
  speed: 3
  name: bar
  gains:
    - 1
    - fast
)",
                                    "my.yaml");
  const Node robot = node.child("robot");
  EXPECT_EQ(error_of([&] {
              robot.number("speed", {0, 1});
            }),
            "my.yaml:2: robot.speed: '3' is out of range; allowed: 0 to 1");
  EXPECT_EQ(error_of([&] {
              robot.number("name", {0, 1});
            }),
            "my.yaml:3: robot.name: 'bar' is not a finite number; allowed: 0 to 1");
  EXPECT_EQ(error_of([&] {
              robot.choice("name", {"a", "b"});
            }),
            "my.yaml:3: robot.name: 'bar' is unknown; allowed: a, b");
  EXPECT_EQ(error_of([&] { robot.numbers("gains", 2); }),
            "my.yaml:6: robot.gains.1: 'fast' is not a finite number; allowed: any finite number");
  EXPECT_EQ(error_of([&] { robot.number("mass", {0}); }),
            "my.yaml:1: robot.mass: is missing; allowed: at least 0");
  EXPECT_EQ(error_of([&] { robot.fail("name", "is odd"); }), "my.yaml:3: robot.name: is odd");
  EXPECT_EQ(error_of([&] { robot.fail("", "is odd"); }), "my.yaml:1: robot: is odd");
}

TEST(Node, RefusesWrongTypes) {
  const Node node = Node::from_text(R"(
nan: .nan
inf: .inf
minus: -.inf
huge: 1e999
bare: nan
quoted: "1"
text: yes
half: 1.5
octal: 0x10
trailing: 1 2
wide: 3000000000
list: [1, 2]
map: {a: 1}
nothing:
)");
  for (const std::string& key : node.keys()) {
    if (key == "half" || key == "wide") continue;
    EXPECT_NE(error_of([&] { node.number(key, {}); }), "") << key;
  }
  for (const std::string& key : node.keys()) {
    EXPECT_NE(error_of([&] { node.integer(key, {}); }), "") << key;
    EXPECT_NE(error_of([&] { node.flag(key, true); }), "") << key;
    EXPECT_NE(error_of([&] { node.vector3(key); }), "") << key;
    if (key != "list") {
      EXPECT_NE(error_of([&] { node.points(key); }), "") << key;
      EXPECT_NE(error_of([&] { node.texts(key); }), "") << key;
    }
    if (key != "map") {
      EXPECT_NE(error_of([&] { node.child(key); }), "") << key;
    }
    if (key != "nothing") {
      EXPECT_NE(error_of([&] { node.list(key); }), "") << key;
    }
  }
  for (const char* key : {"list", "map", "nothing"}) {
    EXPECT_NE(error_of([&] { node.text(key); }), "") << key;
    EXPECT_NE(error_of([&] { node.choice(key, {"a"}); }), "") << key;
  }
}

TEST(Node, ReadsPoses) {
  const Node node = Node::from_text(R"(
a: {position: [1, 2, 3], quaternion: [0.7071067811865476, 0, 0, 0.7071067811865476]}
b: {position: [1, 2, 3], rpy_deg: [0, 0, 90]}
c: {rpy_deg: [90, 0, 90]}
wrong: {quaternion: [1, 1, 0, 0]}
both: {quaternion: [1, 0, 0, 0], rpy_deg: [0, 0, 0]}
)");
  EXPECT_LT((node.pose("a").matrix() - node.pose("b").matrix()).norm(), 1e-15);
  EXPECT_LT((node.pose("a") * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-15);
  // Roll is applied first: y goes to z, which yaw leaves unchanged.
  EXPECT_LT((node.pose("c") * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_THAT(error_of([&] { node.pose("wrong"); }),
              AllOf(StartsWith("<text>:5: wrong.quaternion: "), HasSubstr("unit")));
  EXPECT_THAT(error_of([&] { node.pose("both"); }), HasSubstr("both.rpy_deg"));
}

TEST(Node, UnknownKeysAreFoundWhereverTheyHide) {
  const std::string text = R"(
a: 1
list:
  - {b: 2, c: 3}
map: {d: 4}
)";
  const Node node = Node::from_text(text);
  EXPECT_EQ(error_of([&] { node.check_all_used(); }), "<text>:2: a: unknown key; allowed: nothing");
  node.number("a", {});
  const std::vector<Node> items = node.list("list");
  items[0].number("b", {});
  items[0].number("e", {}, 0);
  const Node map = node.child("map");
  EXPECT_EQ(error_of([&] { node.check_all_used(); }),
            "<text>:4: list.0.c: unknown key; allowed: b, e");
  items[0].number("c", {});
  EXPECT_FALSE(map.has("f"));
  EXPECT_THAT(error_of([&] { node.check_all_used(); }), HasSubstr("map.d: unknown key"));
  EXPECT_NO_THROW(items[0].check_all_used());
  map.number("d", {});
  EXPECT_NO_THROW(node.check_all_used());
}

/// Lists of ten references to the previous list: few lines that expand to 10^rows texts.
std::string grown_by_aliases(int rows) {
  std::string text = "a0: &a0 lol\n";
  for (int i = 1; i <= rows; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int k = 1; k < 10; ++k) text += ", " + below;
    text += "]\n";
  }
  return text;
}

TEST(Node, AliasesCountAsWhatTheyStandFor) {
  EXPECT_EQ(Node::from_text("a: &a [1, 2, 3]\nb: *a").numbers("b", 3).at(2), 3);
  EXPECT_NO_THROW(Node::from_text(grown_by_aliases(4)));
  EXPECT_THAT(error_of([] { Node::from_text(grown_by_aliases(12), "f"); }),
              StartsWith("f:6: the configuration has more than 100000 items"));
  EXPECT_THAT(error_of([] { Node::from_text("a: &a [1, *a]", "f"); }),
              StartsWith("f:1: the configuration has an alias (*name)"));
  std::string deeper = "a0: &a0 []\n";
  for (int i = 1; i < 60; ++i)
    deeper += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" +
              std::to_string(i - 1) + "]\n";
  EXPECT_THAT(error_of([&] { Node::from_text(deeper, "f"); }),
              AllOf(StartsWith("f:50: "), HasSubstr("nested more than 50 deep")));
}

TEST(Node, RefusesWhatIsDeeperOrLargerThanAnyConfiguration) {
  const std::string list = std::string(49, '[') + std::string(49, ']');
  EXPECT_NO_THROW(Node::from_text("a: " + list));
  EXPECT_THAT(error_of([&] { Node::from_text("a: [" + list + "]", "f"); }),
              StartsWith("f:1: the configuration is nested more than 50 deep"));
  EXPECT_THAT(error_of([] { Node::from_text("a: " + std::string(100000, '['), "f"); }),
              StartsWith("f:1: "));
  std::string long_list = "a: [0";
  for (int i = 0; i < 100000; ++i) long_list += ", 0";
  EXPECT_THAT(error_of([&] { Node::from_text(long_list + "]", "f"); }),
              HasSubstr("more than 100000 items"));
}

TEST(Node, RefusesTextThatIsNotOneMapping) {
  EXPECT_THAT(error_of([] { Node::from_text("a: [1\nb: 2", "f"); }),
              AllOf(StartsWith("f:"), HasSubstr("not valid YAML")));
  EXPECT_THAT(error_of([] { Node::from_text("- 1\n- 2", "f"); }), StartsWith("f:1: "));
  EXPECT_THAT(error_of([] { Node::from_text("a: 1\nb: {c: 1,\n c: 2}", "f"); }),
              AllOf(StartsWith("f:3: b.c: "), HasSubstr("twice")));
  EXPECT_NE(error_of([] { Node::from_text("a: 1\n---\nb: 2"); }), "");
  EXPECT_NE(error_of([] { Node::from_text("[1, 2]: 3"); }), "");
  EXPECT_NE(error_of([] { Node::from_text("a: &x {b: *x}"); }), "");
  EXPECT_NE(error_of([] { Node::from_text("a: *nowhere"); }), "");
}

TEST(Node, ChangedPutsEntriesOverOrInPlace) {
  const Node root = Node::from_text("a: {b: 1, c: [1, 2]}\nd: [{e: 1}, {e: 2, f: 3}]", "file");
  const Node over = root.changed("a", "{b: 5}", false, "change");
  EXPECT_EQ(over.child("a").number("b", {}), 5);
  EXPECT_EQ(over.child("a").numbers("c", 2)[1], 2);
  const Node in_place = root.changed("d.1", "{g: 7}", true, "change");
  EXPECT_EQ(in_place.list("d")[1].number("g", {}), 7);
  EXPECT_FALSE(in_place.list("d")[1].has("f"));
  EXPECT_EQ(in_place.list("d")[0].number("e", {}), 1);
  const Node top = root.changed("", "{a: {b: 6}, h: 1}", false, "change");
  EXPECT_EQ(top.child("a").number("b", {}), 6);
  EXPECT_EQ(top.number("h", {}), 1);
  EXPECT_EQ(root.child("a").number("b", {}), 1) << "the original changed";
  EXPECT_NE(root.hash(), over.hash());
}

TEST(Node, ChangedNamesItselfInErrors) {
  const Node root = Node::from_text("a: {b: 1}\nd: [{e: 1}, {f: 3}]", "file");
  EXPECT_THROW(root.changed("a", "{b: ", false, "change"), Error);
  EXPECT_THROW(root.changed("z", "{b: 1}", false, "change"), Error);
  for (const char* nowhere :
       {"a.b.c", "d.x", "d.9", "d.-1", "d.99999999999999999999999", "d.1.f.h"})
    for (const bool replace : {false, true})
      EXPECT_THROW(root.changed(nowhere, "{b: 1}", replace, "change"), Error) << nowhere;
  try {
    root.changed("a", "{b: 50}", false, "change").child("a").number("b", {0, 1});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("override 'change'"), std::string::npos)
        << error.what();
  }
}

TEST(Node, DumpForgetsTheStyle) {
  const Node flow = Node::from_text("a: {b: 1, c: [1, x]}", "flow");
  const Node block = Node::from_text("a:\n  b: 1\n  c:\n    - 1\n    - x\n", "block");
  EXPECT_EQ(flow.child("a").dump("b"), "1");
  EXPECT_EQ(flow.dump("z"), "");
  EXPECT_EQ(flow.dump("a"), block.dump("a"));
}

}  // namespace
}  // namespace palpate::config
