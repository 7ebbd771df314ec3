#include "tools/common/output_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/scratch_folder.hpp"

namespace palpate::common {
namespace {

TEST(WriteJson, WritesAFileThatReadsBackTheSame) {
  const support::ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "out.json";
  const nlohmann::json json = {{"a", {1, 2.5}}, {"b", "text"}};
  write_json(json, file);
  std::ifstream in(file);
  EXPECT_EQ(nlohmann::json::parse(in), json);
}

TEST(WriteJson, ADashIsStandardOutput) {
  ::testing::internal::CaptureStdout();
  write_json({{"a", 1}}, "-");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "{\n  \"a\": 1\n}\n");
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(WriteJson, NamesAFileThatCannotBeWritten) {
  const support::ScratchFolder folder;
  try {
    write_json({}, folder.path() / "none" / "out.json");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none/out.json"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace palpate::common
