// Configuration files: bases, overrides, paths.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "rt/config/node.hpp"
#include "tests/unit/rt/config/error_of.hpp"

namespace palpate::config {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ConfigFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("palpate_config_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& text, const std::string& name = "test.yaml") {
    const std::string path = (folder_ / name).string();
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream(path) << text;
    return path;
  }

  std::filesystem::path folder_;
};

TEST_F(ConfigFile, MissingFilesAreErrors) {
  const std::string missing = (folder_ / "none.yaml").string();
  EXPECT_THAT(error_of([&] { Node::load_file(missing); }), StartsWith(missing + ": "));
  EXPECT_NE(error_of([&] { Node::load_file(folder_.string()); }), "");
}

TEST_F(ConfigFile, PathsAreRelativeToTheFile) {
  const Node node = Node::load_file(write("mesh: ../meshes/bar.msh\nabsolute: /a/b"));
  EXPECT_EQ(node.path("mesh"), (folder_.parent_path() / "meshes" / "bar.msh").lexically_normal());
  EXPECT_EQ(node.path("absolute"), "/a/b");
}

TEST_F(ConfigFile, OverridesReplaceAndAddValues) {
  const std::string path = write("a: {b: 1, c: 2}\nlist:\n  - {x: 1}\n  - {x: 2}\n");
  const Node node = Node::load_file(
      path, {"a.b=5", "list.1.x=7", "new.deep.key=[1, 2, 3]", "a={b: 8, c: 9}", "a.c=10"});
  EXPECT_EQ(node.child("a").integer("b", {}), 8);
  EXPECT_EQ(node.child("a").integer("c", {}), 10);
  EXPECT_EQ(node.list("list")[0].integer("x", {}), 1);
  EXPECT_EQ(node.list("list")[1].integer("x", {}), 7);
  EXPECT_EQ(node.child("new").child("deep").vector3("key"), Eigen::Vector3d(1, 2, 3));
  EXPECT_NO_THROW(node.check_all_used());
}

TEST_F(ConfigFile, AnEmptyOverrideTakesAKeyAway) {
  const std::string path = write("a: {b: 1, c: 2}\nlist: [{x: 1}]\n");
  const Node node = Node::load_file(path, {"a.b=~", "list.0.x=null"});
  EXPECT_FALSE(node.child("a").has("b"));
  EXPECT_EQ(node.child("a").integer("c", {}), 2);
  EXPECT_FALSE(node.list("list")[0].has("x"));
  for (const char* wrong : {"a.b=", "a.d=~", "e=~", "e.f=~"}) {
    EXPECT_THAT(error_of([&] { Node::load_file(path, {wrong}); }), StartsWith("override '"))
        << wrong;
  }
}

TEST_F(ConfigFile, ErrorsOfOverriddenValuesNameTheOverride) {
  const std::string path = write("a: {b: 1}\nlist: [{x: 1}]\n");
  const Node node = Node::load_file(path, {"a.b=fast", "typo.key=1"});
  EXPECT_THAT(error_of([&] { node.child("a").number("b", {}); }),
              StartsWith("override 'a.b=fast': a.b: 'fast'"));
  node.list("list")[0].number("x", {});
  EXPECT_THAT(error_of([&] { node.check_all_used(); }),
              StartsWith("override 'typo.key=1': typo: unknown key"));
  for (const char* wrong :
       {"a.b", "=1", "a..b=1", "a.b.c=1", "list.1.x=1", "list.x=1", "a.b=[", "a.b={c: 1, c: 2}"}) {
    EXPECT_THAT(error_of([&] { Node::load_file(path, {wrong}); }), StartsWith("override '"))
        << wrong;
  }
}

TEST_F(ConfigFile, EntriesGoOverThoseOfTheBase) {
  write("a: {b: 1, c: {d: 2, e: 3}}\nlist: [{x: 1}, {x: 2}]\nkept: low\n", "low.yaml");
  write("base: low.yaml\na: {c: {d: 4}}\nadded: mid\n", "mid.yaml");
  const Node node = Node::load_file(
      write("base: mid.yaml\nlist: [{x: 7}]\na: {b: 5}\nnew: {f: 6}\n"), {"a.c.e=8"});
  EXPECT_EQ(node.child("a").integer("b", {}), 5);
  EXPECT_EQ(node.child("a").child("c").integer("d", {}), 4);
  EXPECT_EQ(node.child("a").child("c").integer("e", {}), 8);
  ASSERT_EQ(node.list("list").size(), 1u);  // lists are replaced as a whole
  EXPECT_EQ(node.list("list")[0].integer("x", {}), 7);
  EXPECT_EQ(node.text("kept"), "low");
  EXPECT_EQ(node.text("added"), "mid");
  EXPECT_EQ(node.child("new").integer("f", {}), 6);
  EXPECT_NO_THROW(node.check_all_used());  // `base` is not one of the reader's keys
}

TEST_F(ConfigFile, AnEmptyEntryTakesAwayThatOfTheBase) {
  write("mesh: {box: {size: 1}, order: 2}\nkept: low\n", "low.yaml");
  const Node node = Node::load_file(write("base: low.yaml\nmesh: {box: ~, file: bar.msh}\n"));
  const Node mesh = node.child("mesh");
  EXPECT_FALSE(mesh.has("box"));
  EXPECT_EQ(mesh.text("file"), "bar.msh");
  EXPECT_EQ(mesh.integer("order", {}), 2);
  EXPECT_EQ(node.text("kept"), "low");
  EXPECT_NO_THROW(node.check_all_used());
}

TEST_F(ConfigFile, ValuesRememberTheFileTheyAreFrom) {
  const std::string low = write("# why\na: {b: low,\n  c: low}\nmesh: bar.msh\n", "deep/low.yaml");
  const std::string top = write("base: deep/low.yaml\n\na:\n  b: top\nown: foo.msh\n");
  const Node node = Node::load_file(top), a = node.child("a");
  EXPECT_THAT(error_of([&] { a.number("b", {}); }), StartsWith(top + ":4: a.b: 'top'"));
  EXPECT_THAT(error_of([&] { a.number("c", {}); }), StartsWith(low + ":3: a.c: 'low'"));
  EXPECT_THAT(error_of([&] { node.number("absent", {}); }), StartsWith(top + ":1: absent"));
  EXPECT_EQ(node.path("mesh"), (folder_ / "deep" / "bar.msh").string());
  EXPECT_EQ(node.path("own"), (folder_ / "foo.msh").string());
}

TEST_F(ConfigFile, ABaseThatCannotBeUsedIsAnError) {
  const std::string top = write("# why\nbase: none.yaml\n");
  EXPECT_EQ(error_of([&] { Node::load_file(top); }),
            top + ":2: base: there is no file '" + (folder_ / "none.yaml").string() + "'");
  write("base: [none.yaml]\n");
  EXPECT_EQ(error_of([&] { Node::load_file(top); }), top + ":1: base: is not the name of a file");
  write("base: .\n");
  EXPECT_THAT(error_of([&] { Node::load_file(top); }), HasSubstr("there is no file"));

  write("base: test.yaml\n");
  EXPECT_THAT(error_of([&] { Node::load_file(top); }), HasSubstr("this file itself"));
  const std::string other = write("a: 1\nbase: deep/../test.yaml\n", "other.yaml");
  write("base: other.yaml\n");
  EXPECT_EQ(error_of([&] { Node::load_file(top); }),
            other + ":2: base: '" + top + "' builds on this file itself");
  write("base: broken.yaml\n");
  const std::string broken = write("a: {b: 1, b: 2}\n", "broken.yaml");
  EXPECT_EQ(error_of([&] { Node::load_file(top); }), broken + ":1: a.b: given twice");
}

TEST_F(ConfigFile, HashFollowsContentNotComments) {
  const auto hash = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    return Node::load_file(write(text), overrides).hash();
  };
  EXPECT_EQ(hash("a: 1\nb: 2"), hash("# why\na: 1\nb:   2"));
  EXPECT_NE(hash("a: 1\nb: 2"), hash("a: 1\nb: 3"));
  EXPECT_EQ(hash("a: 1\nb: 2", {"b=3"}), hash("a: 1\nb: 3"));
  write("a: 1\nb: 3", "low.yaml");
  EXPECT_EQ(hash("base: low.yaml\nb: 2"), hash("a: 1\nb: 2"));
}

}  // namespace
}  // namespace palpate::config
