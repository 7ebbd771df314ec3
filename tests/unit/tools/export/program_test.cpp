#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/unit/tools/export/python.hpp"
#include "tests/unit/tools/export/small_run.hpp"

namespace palpate::exporting {
namespace {

class ProgramTest : public testing::Test {
 protected:
  Answer program(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), PALPATE_EXPORT_PROGRAM);
    return run(arguments);
  }
  std::string path(const std::string& name) const { return (run_.folder() / name).string(); }

  SmallRun run_;
};

TEST_F(ProgramTest, HelpSuffices) {
  const Answer all = program({"--help"});
  EXPECT_EQ(all.code, 0);
  for (const char* command : {"info", "csv", "plot", "mcap", "vtu", "png", "mp4"}) {
    EXPECT_NE(all.text.find(std::string("palpate-export ") + command), std::string::npos);
    const Answer one = program({command, "--help"});
    EXPECT_EQ(one.code, 0);
    EXPECT_NE(one.text.find("logs"), std::string::npos) << one.text;
  }
}

TEST_F(ProgramTest, ReportsWhatALogHoldsAndWhatIsWrongWithIt) {
  std::filesystem::resize_file(run_.control(), std::filesystem::file_size(run_.control()) - 5);
  const Answer answer =
      program({"info", path("control.log"), path("housekeeping.log"), "--json", path("info.json")});
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_NE(answer.text.find("FT_WRENCH"), std::string::npos);
  EXPECT_NE(answer.text.find("the last event is cut short"), std::string::npos);
  std::ifstream in(path("info.json"));
  const nlohmann::json json = nlohmann::json::parse(in);
  EXPECT_EQ(json["events"], 100 + 3 * 20 + 2 + 3 * SmallRun::kShapes - 1);
  EXPECT_EQ(json["damage"].size(), 1u);
}

TEST_F(ProgramTest, WritesWhatIsAskedForAndNothingWhereItFails) {
  const Answer csv = program(
      {"csv", path("control.log"), "--channel", "FT_WRENCH", "CONTACTS", "--output", path("out")});
  EXPECT_EQ(csv.code, 0) << csv.text;
  EXPECT_TRUE(std::filesystem::exists(run_.folder() / "out/CONTACTS.csv"));
  EXPECT_FALSE(std::filesystem::exists(run_.folder() / "out/ESTIMATE.csv"));
  const Answer list = program({"plot", path("control.log"), "--list"});
  EXPECT_EQ(list.code, 0) << list.text;
  EXPECT_NE(list.text.find("wrench[6]"), std::string::npos);

  const Answer none = program({"png", path("control.log"), "-o", path("a.png")});
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.text.find("housekeeping"), std::string::npos) << none.text;
  const Answer absent = program({"csv", path("absent.log"), "-o", path("out")});
  EXPECT_NE(absent.code, 0);
  EXPECT_NE(absent.text.find("absent.log"), std::string::npos) << absent.text;
  std::ofstream(path("text.log")) << std::string(1000, 'x');
  const Answer text = program({"mcap", path("text.log"), "-o", path("a.mcap")});
  EXPECT_EQ(text.code, 1);
  EXPECT_NE(text.text.find("no LCM event log"), std::string::npos) << text.text;
  std::ofstream(path("wrong.yaml")) << "frames: {object_in_base: 3}\n";
  const Answer wrong =
      program({"mcap", path("control.log"), "-o", path("a.mcap"), "--config", path("wrong.yaml")});
  EXPECT_EQ(wrong.code, 78) << wrong.text;
  EXPECT_NE(wrong.text.find("object_in_base"), std::string::npos) << wrong.text;
  const Answer odd =
      program({"mp4", path("housekeeping.log"), "--width", "201", "-o", path("a.mp4")});
  EXPECT_EQ(odd.code, 1) << odd.text;
  for (const char* file : {"a.png", "a.mcap", "a.mcap.part", "a.mp4", "a.part.mp4"})
    EXPECT_FALSE(std::filesystem::exists(run_.folder() / file)) << file;
}

}  // namespace
}  // namespace palpate::exporting
