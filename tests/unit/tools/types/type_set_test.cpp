#include "tools/types/type_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"
#include "tools/log/type_table.hpp"

namespace palpate::types {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  try {
    TypeSet(text, "a.lcm");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TypeSet, OwnTypesHaveTheFingerprintsOfTheGeneratedCode) {
  ASSERT_GT(log::types().size(), 30u);
  EXPECT_EQ(own_types().structs().size(), log::types().size());
  for (const log::TypeInfo& type : log::types()) {
    const Struct* described = own_types().find("palpate." + type.name);
    ASSERT_NE(described, nullptr) << type.name;
    EXPECT_EQ(described->fingerprint, type.fingerprint) << type.name;
    ASSERT_EQ(described->members.size(), type.fields.size());
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      EXPECT_EQ(described->members[i].name, type.fields[i].name);
      EXPECT_THAT(described->members[i].comment, HasSubstr(type.fields[i].comment));
    }
  }
}

// Hashes that lcm-gen 1.3.1 writes for these types.
TEST(TypeSet, HashIsThatOfLcm) {
  const TypeSet types(
      "package foo.bar;\n"
      "enum colour_t { RED=1, GREEN=2 }\n"
      "struct inner { int8_t n; string names[n][2]; boolean b; byte c; boolean bs[3]; "
      "byte raw[2][n]; }\n"
      "struct of_enum { colour_t colour; }\n",
      "a.lcm");
  EXPECT_EQ(static_cast<std::uint64_t>(types.find("foo.bar.inner")->fingerprint),
            0xaf2e7b7dd4d9ec41u);
  EXPECT_EQ(types.find("foo.bar.of_enum")->members[0].kind, Kind::kEnumeration);
}

TEST(TypeSet, ConstantsAreSizesByTheirValues) {
  const TypeSet by_name("struct a { const int32_t N = 0x3; double x[N]; }", "a.lcm");
  const TypeSet by_value("struct b { double x[0x3]; }", "b.lcm");
  EXPECT_EQ(by_name.find("a")->fingerprint, by_value.find("b")->fingerprint);
  EXPECT_EQ(by_name.find("a")->members[0].dimensions[0].size, 3);
}

TEST(TypeSet, ErrorsNameFileLineAndWhatIsWrong) {
  EXPECT_EQ(error_of("struct a {\n  int x;\n}"),
            "a.lcm:1: a.x: its type int is in none of the descriptions; name its folder too");
  EXPECT_EQ(error_of("struct a {\n  double x[n];\n  int32_t n;\n}"),
            "a.lcm:2: the array's size 'n' is neither a constant nor a member before it");
  EXPECT_EQ(error_of("struct a {\n  double n;\n  double x[n];\n}"),
            "a.lcm:3: 'n' cannot be an array's size: it is no single integer");
  EXPECT_EQ(error_of("struct a {\n  double x;\n  float x;\n}"), "a.lcm:3: a has 'x' twice");
  EXPECT_EQ(error_of("struct a {\n  double x[0];\n}"),
            "a.lcm:2: '0' is no integer from 1 to 2147483647");
  EXPECT_EQ(error_of("struct a {\n  const int8_t X = 128;\n}"),
            "a.lcm:2: '128' is no integer from -128 to 127");
  EXPECT_EQ(error_of("struct a {\n  double x\n}"), "a.lcm:3: ';' is missing before '}'");
  EXPECT_EQ(error_of("struct a { double x; }\nstruct a { }"),
            "a.lcm:2: a is described before, in a.lcm:1");
  EXPECT_EQ(error_of("/* no end"), "a.lcm:1: the comment does not end");
  EXPECT_EQ(error_of("double x;"), "a.lcm:1: 'double' is none of package, struct and enum");
  EXPECT_EQ(error_of("struct a { struct b { } }"),
            "a.lcm:1: types inside of structs are not possible in LCM");
}

TEST(TypeSet, ReadsFoldersWithSubfolders) {
  const support::ScratchFolder folder;
  std::filesystem::create_directories(folder.path() / "deep/er");
  std::ofstream(folder.path() / "a.lcm") << "package p; struct a { p.b one; b two[2]; }";
  std::ofstream(folder.path() / "deep/er/b.lcm")
      << "package p;\n// A number.\nstruct b { int8_t x; }";
  std::ofstream(folder.path() / "readme.txt") << "none of this";
  const TypeSet types(std::vector<std::filesystem::path>{folder.path(), folder.path() / "a.lcm"});
  ASSERT_EQ(types.structs().size(), 2u);
  EXPECT_EQ(types.find("p.a")->members[1].content, types.find("p.b"));
  EXPECT_EQ(types.find("p.b")->comment, "A number.");
  EXPECT_THROW(TypeSet(std::vector{folder.path() / "deep/er/none.lcm"}), std::runtime_error);
}

}  // namespace
}  // namespace palpate::types
