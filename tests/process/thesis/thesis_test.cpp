// palpate-evaluate thesis with real programs, on ports of its own.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/unit/tools/evaluate/thesis_folder.hpp"

namespace palpate::evaluate {
namespace {

constexpr const char* kPlan = R"(octree_resolution: 0.01
applications:
  - name: short pull
    kind: control
    scene: sim/scenes/bar_long_soft_control.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    methods: [pose-driven]
    mismatch: [none]
    seeds: [1]
    duration: 1.5
    target: {feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]}
)";

class ThesisProcess : public testing::Test {
 protected:
  int run(const std::string& output, const std::string& options = "") const {
    const std::string command = std::string(PALPATE_BIN_DIR) + "/palpate-evaluate thesis --plan '" +
                                folder_.file("plan.yaml").string() + "' --out '" +
                                folder_.file(output).string() + "' " + options + " > '" +
                                folder_.file(output + ".txt").string() + "' 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  nlohmann::json result(const std::string& output) const {
    return nlohmann::json::parse(
        folder_.read(output + "/short_pull_pose_driven_none_1/result.json"));
  }
  /// The same job until its log has every message: what a busy machine's logger misses is not the
  /// run's. Ten times at most.
  nlohmann::json run_until_logged(const std::string& output) const {
    nlohmann::json json;
    for (int i = 0; i < 10; ++i) {
      std::filesystem::remove_all(folder_.file(output));
      EXPECT_EQ(run(output), 0) << folder_.read(output + ".txt");
      json = result(output);
      if (json["features_lost_by_log"] == 0) return json;
    }
    ADD_FAILURE() << "every log has lost something: " << json["features_lost_by_log"];
    return json;
  }
  ThesisFolder folder_;
};

TEST_F(ThesisProcess, RunsAJobOnceAndGivesTheSameTwice) {
  folder_.write("plan.yaml", kPlan);
  const nlohmann::json first = run_until_logged("a");
  EXPECT_EQ(first["simulator"]["mode"], "lock-step");
  EXPECT_EQ(first["simulator"]["ticks"], 1500);
  // The pull has begun, towards its target.
  EXPECT_LT(first["score"]["feature"]["error_mm"], first["score"]["feature"]["start_error_mm"]);
  EXPECT_GT(first["states"][0]["octree_truth_in_estimate"], 0.5);
  EXPECT_NE(folder_.read("a/report.html").find("short pull"), std::string::npos);

  ASSERT_EQ(run("a"), 0);
  EXPECT_NE(folder_.read("a.txt").find("0 jobs run, 1 kept"), std::string::npos)
      << folder_.read("a.txt");
  const nlohmann::json second = run_until_logged("b");
  EXPECT_EQ(second["score"]["feature"], first["score"]["feature"]);
  EXPECT_EQ(second["states"], first["states"]);
}

TEST_F(ThesisProcess, AJobThatFailsIsExitCodeOne) {
  std::string plan = kPlan;
  const std::string good = "duration: 1.5";
  folder_.write("plan.yaml", plan.replace(plan.find(good), good.size(),
                                          "duration: 1.5\n    states: [{name: never, time: 1.5}]"));
  EXPECT_EQ(run("a"), 1) << folder_.read("a.txt");
  EXPECT_NE(folder_.read("a.txt").find("does not reach the state"), std::string::npos)
      << folder_.read("a.txt");
  EXPECT_EQ(run("a", "--list"), 0);
  EXPECT_NE(folder_.read("a.txt").find("1 jobs"), std::string::npos);
}

TEST_F(ThesisProcess, AWrongPlanIsAConfigurationError) {
  folder_.write("plan.yaml", "octree_resolution: 0.01\n");
  EXPECT_EQ(run("a"), 78);
  EXPECT_NE(folder_.read("a.txt").find("applications"), std::string::npos);
}

}  // namespace
}  // namespace palpate::evaluate
