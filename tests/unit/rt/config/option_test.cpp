#include "rt/config/option.hpp"

#include <gtest/gtest.h>

#include "rt/config/declarations.hpp"
#include "rt/config/node.hpp"
#include "tests/unit/rt/config/error_of.hpp"

namespace palpate::config {
namespace {

struct Part {
  double length = 0.3;  // m
};

struct Options {
  double fade = 0.1;  // s
  double limit = 0;   // N; 0: none
  int count = 3;
  Part part;
};

OptionTable<Options> table() {
  return OptionTable<Options>()
      .number("fade_ms", "ms", "Time constant of the fade", {1, 1e4}, &Options::fade, 1e-3)
      .alias("decay_ms")
      .number("limit", "N", "Largest force; absent: no limit", {1, 10}, &Options::limit)
      .optional()
      .integer("count", "Number of things", {1, 5}, &Options::count)
      .part(OptionTable<Part>().number("length_mm", "mm", "Length", {1, 1e4}, &Part::length, 1e-3),
            &Options::part);
}

Node from(const std::string& text) { return Node::from_text(text, "t.yaml"); }

TEST(OptionTable, ValuesReachTheirMembersInSiUnits) {
  const Options options = from("{fade_ms: 20, limit: 2, count: 4, length_mm: 5}").read(table());
  EXPECT_DOUBLE_EQ(options.fade, 0.02);
  EXPECT_EQ(options.limit, 2);
  EXPECT_EQ(options.count, 4);
  EXPECT_DOUBLE_EQ(options.part.length, 0.005);
}

TEST(OptionTable, AbsentKeysMeanTheDefaults) {
  const Options options = from("{}").read(table());
  EXPECT_EQ(options.fade, 0.1);
  EXPECT_EQ(options.limit, 0) << "outside the range of a key that is given";
  EXPECT_EQ(options.count, 3);
  EXPECT_EQ(options.part.length, 0.3);
}

TEST(OptionTable, AnOptionalKeyIsDeclaredWithoutADefault) {
  for (const char* text : {"{}", "{limit: 5}"}) {
    DeclarationList list;
    from(text).read(table());
    const Declaration* limit = list.find("t.yaml", "", "limit");
    ASSERT_NE(limit, nullptr);
    EXPECT_FALSE(limit->required);
    EXPECT_EQ(limit->fallback, "");
    EXPECT_EQ(limit->range.upper, 10);
  }
}

TEST(OptionTable, AFormerNameIsAcceptedWithAWarning) {
  const Node node = from("decay_ms: 20");
  DeclarationList list;
  EXPECT_DOUBLE_EQ(node.read(table()).fade, 0.02);
  node.read(table());
  node.check_all_used();
  ASSERT_EQ(node.warnings().size(), 1U);
  EXPECT_EQ(node.warnings()[0], "t.yaml:1: decay_ms: is the former name of 'fade_ms': rename it");
  EXPECT_NE(list.find("t.yaml", "", "fade_ms"), nullptr);
  EXPECT_EQ(list.find("t.yaml", "", "decay_ms"), nullptr);
  EXPECT_TRUE(from("fade_ms: 20").warnings().empty());
}

TEST(OptionTable, AFormerNameKeepsTheRangeAndExcludesThePresentOne) {
  EXPECT_EQ(error_of([] { from("decay_ms: 0").read(table()); }),
            "t.yaml:1: decay_ms: '0' is out of range; allowed: 1 to 10000");
  const std::string both = error_of([] { from("{fade_ms: 2, decay_ms: 2}").read(table()); });
  EXPECT_NE(both.find("decay_ms: is the former name of 'fade_ms', which is given as well"),
            std::string::npos)
      << both;
}

}  // namespace
}  // namespace palpate::config
