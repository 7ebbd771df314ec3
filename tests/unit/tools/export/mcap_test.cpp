#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/unit/tools/export/python.hpp"
#include "tests/unit/tools/export/small_run.hpp"
#include "tools/export/mcap_export.hpp"
#include "tools/export/mcap_writer.hpp"

namespace palpate::exporting {
namespace {

class McapTest : public testing::TestWithParam<Compression> {};

TEST_P(McapTest, AStrictReaderFindsEverythingInItsPlace) {
  const SmallRun run;
  Source source(quiet({run.control(), run.housekeeping()}));
  const auto file = run.folder() / "run.mcap";
  McapOptions options;
  options.compression = GetParam();
  options.X_WO = math::Pose::Identity();
  export_mcap(source, options, file);
  const Answer answer = run_python("read_mcap.py", {file.string()});
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json read = nlohmann::json::parse(answer.text);
  EXPECT_EQ(read["counts"]["FT_WRENCH"], 100);
  EXPECT_EQ(read["counts"]["TRUTH_SHAPE"], 42);
  EXPECT_EQ(read["counts"]["SHAPE_MESH"], 1);
  EXPECT_EQ(read["counts"]["/shape/estimate"], SmallRun::kShapes);  // 20 Hz of both
  EXPECT_EQ(read["counts"]["/shape/truth"], SmallRun::kShapes);
  EXPECT_EQ(read["counts"]["/flange"], 20);

  const nlohmann::json& wrench = read["last"]["FT_WRENCH"];
  const std::int64_t last = SmallRun::kStart + 990'000;
  EXPECT_EQ(wrench["schema"], "palpate.ft_wrench_t");
  EXPECT_EQ(wrench["log_time"], 1000 * last);
  EXPECT_EQ(wrench["publish_time"], 1000 * (last - 1000));
  EXPECT_EQ(wrench["sequence"], 99);
  EXPECT_EQ(wrench["data"]["wrench"][3], 0.5 * 99 + 3);
  const nlohmann::json& scene = read["last"]["/shape/estimate"];
  EXPECT_EQ(scene["schema"], "foxglove.SceneUpdate");
  const nlohmann::json& entity = scene["data"]["entities"][0];
  EXPECT_EQ(entity["frame_id"], "O");
  EXPECT_EQ(entity["triangles"][0]["points"].size(), 24u);
  EXPECT_EQ(entity["triangles"][0]["colors"].size(), 24u);
  EXPECT_NEAR(entity["triangles"][0]["points"][5]["x"], 0.22, 1e-6);
  EXPECT_EQ(entity["arrows"].size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(EachCompression, McapTest,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd),
                         [](const auto& tested) {
                           const std::string name = name_of(tested.param);
                           return name.empty() ? "none" : name;
                         });

TEST(Mcap, WithoutAMeshThereAreMessagesButNoScenes) {
  const SmallRun run;
  const auto log = run.folder() / "log", file = run.folder() / "run.mcap";
  LogWriter(log).write("SHAPE", 2, shape_message(run.estimate_mesh, run.estimate_mesh.nodes, 2));
  Source source(quiet({log}));
  testing::internal::CaptureStderr();
  export_mcap(source, {}, file);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("no scenes"), std::string::npos);
  const Answer answer = run_python("read_mcap.py", {file.string()});
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_EQ(nlohmann::json::parse(answer.text)["counts"], nlohmann::json({{"SHAPE", 1}}));
}

TEST(Mcap, ManyChunksWithMessagesOutOfOrder) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "file.mcap";
  McapWriter mcap(file, Compression::kZstd, 4000);
  const std::string schema = R"({"type": "object", "properties": {"x": {"type": "integer"}}})";
  const std::uint16_t one = mcap.add_schema("one", schema), two = mcap.add_schema("two", schema);
  const std::uint16_t a = mcap.add_channel("a", one), b = mcap.add_channel("b", two, {{"k", "v"}});
  mcap.add_metadata("about", {{"what", "a test"}});
  for (int i = 0; i < 1000; ++i)
    mcap.add_message(i % 3 == 0 ? a : b, static_cast<std::uint32_t>(i),
                     static_cast<std::uint64_t>(i % 2 == 0 ? i : 2000 - i), 0,
                     "{\"x\": " + std::to_string(i) + "}");
  // A channel that starts late, and one without messages.
  const std::uint16_t c = mcap.add_channel("c", one);
  mcap.add_channel("silent", one);
  mcap.add_message(c, 0, 5, 5, "{}");
  EXPECT_FALSE(std::filesystem::exists(file)) << "not before it is whole";
  mcap.finish();
  const Answer answer = run_python("read_mcap.py", {file.string()});
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json read = nlohmann::json::parse(answer.text);
  EXPECT_EQ(read["counts"]["a"], 334);
  EXPECT_EQ(read["counts"]["b"], 666);
  EXPECT_EQ(read["counts"]["c"], 1);
  EXPECT_GT(read["chunks"], 5);
  EXPECT_EQ(read["metadata"][0][1]["what"], "a test");
}

TEST(Mcap, AFileWithoutMessagesIsOneToo) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "file.mcap";
  McapWriter(file, Compression::kLz4).finish();
  const Answer answer = run_python("read_mcap.py", {file.string()});
  EXPECT_EQ(answer.code, 0) << answer.text;
}

// The reader does detect errors: one bit changed in each part of a file.
TEST(Mcap, TheReaderOfTheseTestsIsStrict) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "file.mcap";
  McapWriter mcap(file, Compression::kNone);
  const std::uint16_t schema =
      mcap.add_schema("one", R"({"type": "object", "properties": {"x": {"type": "integer"}}})");
  const std::uint16_t channel = mcap.add_channel("a", schema);
  for (int i = 0; i < 3; ++i) mcap.add_message(channel, 0, 7, 7, "{\"x\": 1}");
  mcap.finish();
  ASSERT_EQ(run_python("read_mcap.py", {file.string()}).code, 0);
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file));
  for (const std::streamoff place :
       {std::streamoff{5}, size / 4, size / 2, 3 * size / 4, size - 20}) {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekg(place);
    const int before = bytes.get();
    bytes.seekp(place);
    bytes.put(static_cast<char>(before ^ 1));
    bytes.flush();
    EXPECT_NE(run_python("read_mcap.py", {file.string()}).code, 0) << "byte " << place;
    bytes.seekp(place);
    bytes.put(static_cast<char>(before));
  }
}

}  // namespace
}  // namespace palpate::exporting
