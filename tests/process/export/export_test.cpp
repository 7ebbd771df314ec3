// Exported files opened by their target programs; skipped if these are not installed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/child_process.hpp"
#include "tests/unit/tools/export/small_run.hpp"

namespace palpate::exporting {
namespace {

using std::chrono::milliseconds;

const std::string kHere = PALPATE_SOURCE_DIR "/tests/process/export/";

/// Path of a program found by PATH; empty if it is not installed.
std::string path_of(const std::string& program) {
  const char* folders = std::getenv("PATH");
  std::istringstream all(folders == nullptr ? "/usr/bin" : folders);
  for (std::string folder; std::getline(all, folder, ':');)
    if (std::filesystem::exists(folder + "/" + program)) return folder + "/" + program;
  return "";
}

/// Exit code, and all output of a program.
std::pair<int, std::string> run(const std::vector<std::string>& words) {
  support::ChildProcess program(words);
  const int code = program.wait(milliseconds(240000));
  return {code, program.output()};
}

/// The last line that begins an object.
nlohmann::json json_in(const std::string& text) {
  const std::size_t at = text.rfind("\n{") == std::string::npos ? 0 : text.rfind("\n{") + 1;
  return nlohmann::json::parse(text.substr(at, text.find('\n', at) - at));
}

void expect_exported(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{std::string(PALPATE_BIN_DIR) + "/palpate-export"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto [code, said] = run(words);
  ASSERT_EQ(code, 0) << said;
}

TEST(Opened, ByParaView) {
  const std::string pvpython = path_of("pvpython");
  if (pvpython.empty()) GTEST_SKIP() << "pvpython is not installed (package paraview)";
  const SmallRun made;
  const std::string folder = (made.folder() / "vtu").string();
  expect_exported({"vtu", made.control(), made.housekeeping(), "--truth-stiffness", "30000", "0.3",
                   "--quiet", "-o", folder});
  const std::string estimates = folder + "/estimate.pvd", truths = folder + "/truth.pvd",
                    forces = folder + "/forces.pvd";
  const auto [code, said] =
      run({pvpython, kHere + "read_by_paraview.py", estimates, truths, forces});
  ASSERT_EQ(code, 0) << said;
  const nlohmann::json found = json_in(said);

  const nlohmann::json& estimate = found[estimates];
  ASSERT_EQ(estimate["times"].size(), 11u);
  EXPECT_NEAR(estimate["times"][10], 1.01, 1e-9);
  const Eigen::Matrix3Xd& rest = made.estimate_mesh.nodes;
  ASSERT_EQ(estimate["points"].size(), static_cast<std::size_t>(rest.cols()));
  EXPECT_EQ(estimate["cells"], made.estimate_mesh.elements.cols());
  EXPECT_EQ(estimate["surface"], made.estimate_mesh.triangles.cols());
  const double stretch = SmallRun::stretch(SmallRun::kStart + 1'000'000);
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    const nlohmann::json& point = estimate["points"][static_cast<std::size_t>(i)];
    EXPECT_NEAR(point[0], stretch * rest(0, i), 1e-6) << "node " << i;
    EXPECT_NEAR(point[1], rest(1, i), 1e-6) << "node " << i;
    EXPECT_NEAR(point[2], rest(2, i) + 1e-3, 1e-6) << "node " << i;
  }
  const nlohmann::json& moved = estimate["fields"]["displacement"];
  EXPECT_EQ(moved["components"], 3);
  EXPECT_EQ(moved["values"], rest.cols());
  // Farthest is the bar's end: by its stretch along x and 1 mm along z.
  EXPECT_NEAR(moved["range"][1], std::hypot((stretch - 1) * 0.2, 1e-3), 1e-6);
  EXPECT_NEAR(moved["range"][0], 1e-3, 1e-6);
  EXPECT_EQ(estimate["fields"]["strain"]["components"], 6);
  EXPECT_EQ(estimate["fields"]["von_mises_stress"]["values"], estimate["cells"]);

  const nlohmann::json& truth = found[truths];
  EXPECT_EQ(truth["points"].size(), static_cast<std::size_t>(made.truth_mesh.nodes.cols()));
  EXPECT_EQ(truth["cells"], made.truth_mesh.elements.cols()) << "hexahedra of 27 nodes";
  EXPECT_NEAR(truth["fields"]["displacement"]["range"][1], 0.2 * (stretch - 1), 1e-6);
  EXPECT_EQ(found[forces]["points"].size(), 2u);
  EXPECT_NEAR(found[forces]["fields"]["force"]["range"][1], 2, 1e-6);
}

TEST(Opened, ByTheLibrariesOfFoxglove) {
  const std::string node = path_of("node");
  if (node.empty()) GTEST_SKIP() << "node is not installed";
  setenv("NODE_PATH", PALPATE_SOURCE_DIR "/build/foxglove/node_modules", 0);
  const SmallRun made;
  std::ofstream(made.folder() / "cell.yaml")
      << "frames: {object_in_base: {position: [0.5, 0, 0.2]}}\n";
  for (const std::string compression : {"none", "lz4", "zstd"}) {
    const std::string file = (made.folder() / (compression + ".mcap")).string();
    expect_exported({"mcap", made.control(), made.housekeeping(), "--compression", compression,
                     "--config", made.folder() / "cell.yaml", "--quiet", "-o", file});
    const auto [code, said] = run({node, kHere + "read_by_foxglove.cjs", file});
    if (code == 77) GTEST_SKIP() << said;
    ASSERT_EQ(code, 0) << said;
    const nlohmann::json found = json_in(said);
    EXPECT_TRUE(found["problems"].empty()) << found["problems"].dump(1);
    const auto expect = [&](const char* topic, const char* schema, int messages) {
      const nlohmann::json& channel = found["channels"][topic];
      EXPECT_EQ(channel["schema"], schema) << topic;
      EXPECT_EQ(channel["messages"], messages) << topic;
    };
    expect("FT_WRENCH", "palpate.ft_wrench_t", 100);
    expect("SHAPE", "palpate.shape_t", SmallRun::kShapes);
    expect("TRUTH_SHAPE", "palpate.shape_t", 2 * SmallRun::kShapes);
    expect("/shape/estimate", "foxglove.SceneUpdate", SmallRun::kShapes);
    expect("/shape/truth", "foxglove.SceneUpdate", SmallRun::kShapes);
    expect("/flange", "foxglove.PoseInFrame", 20);
  }
}

TEST(Opened, ByFoxglovesSchemasOfProtobuf) {
  const SmallRun made;
  std::vector<std::string> files;
  for (const std::string kind : {"json", "protobuf"}) {
    files.push_back((made.folder() / (kind + ".mcap")).string());
    std::vector<std::string> words{"mcap",    made.control(), made.housekeeping(),
                                   "--quiet", "-o",           files.back()};
    if (kind == "protobuf") words.emplace_back("--protobuf");
    expect_exported(words);
  }
  const auto [code, said] = run({PALPATE_SOURCE_DIR "/tests/support/in_worlds",
                                 kHere + "read_protobuf.py", files[0], files[1]});
  if (code == 77) GTEST_SKIP() << said;
  ASSERT_EQ(code, 0) << said;
  const nlohmann::json found = json_in(said);
  EXPECT_EQ(found["/shape/estimate"], SmallRun::kShapes);
  EXPECT_EQ(found["/shape/truth"], SmallRun::kShapes);
  EXPECT_EQ(found["/flange"], 20);
}

/// Requirements of PlotJuggler's CSV reader, by its source (3.9): names in the first line, none of
/// them a number and all unique, commas, the same number of cells in every line, and an increasing
/// time column. PlotJuggler itself is not in Debian 12 and was not run.
TEST(Opened, HasWhatPlotJugglersReaderOfCsvAsksFor) {
  const SmallRun made;
  const std::string folder = (made.folder() / "csv").string();
  expect_exported({"csv", made.control(), made.housekeeping(), "--quiet", "-o", folder});
  int tables = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().stem().extension() == ".columns") continue;  // contains units, for people
    std::ifstream in(entry.path());
    std::string line;
    const auto cells = [&line] {
      std::vector<std::string> all(1);
      bool quoted = false;
      for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted)
          all.emplace_back();
        else
          all.back() += c;
      }
      return all;
    };
    ASSERT_TRUE(std::getline(in, line));
    const std::vector<std::string> names = cells();
    EXPECT_EQ(names.front(), "time");
    std::set<std::string> different(names.begin(), names.end());
    EXPECT_EQ(different.size(), names.size()) << entry.path();
    for (const std::string& name : names) {
      char* end = nullptr;
      std::strtod(name.c_str(), &end);
      EXPECT_TRUE(!name.empty() && *end != 0) << entry.path() << ": " << name;
    }
    double before = -1e300;
    while (std::getline(in, line)) {
      const std::vector<std::string> row = cells();
      ASSERT_EQ(row.size(), names.size()) << entry.path() << ": " << line;
      char* end = nullptr;
      const double time = std::strtod(row.front().c_str(), &end);
      ASSERT_EQ(*end, 0) << line;
      EXPECT_GE(time, before) << entry.path();
      before = time;
    }
    ++tables;
  }
  EXPECT_GE(tables, 7);
}

}  // namespace
}  // namespace palpate::exporting
