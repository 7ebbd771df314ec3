// palpate-evaluate's commands for published sensing methods with real programs: what is recorded,
// what is rerun and what is reused, the score of a failure, and the results of training.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "rt/pipeline/pipeline.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"

namespace palpate::evaluate {
namespace {

using ::testing::HasSubstr;

const std::string kRoot = PALPATE_SOURCE_DIR;

constexpr const char* kMotion =
    "motion: {start_delay: 0.2, poses: [{name: up, move: 0.5, hold: 0.6, translation: [0, 0, "
    "0.03], rotation_deg: [0, 0, 0]}]}\n";

class PublishedSensing : public testing::Test {
 protected:
  PublishedSensing() {
    folder_.write("scene.yaml",
                  "base: " + kRoot + "/sim/scenes/bar_long_soft_six_poses.yaml\n" + kMotion);
    folder_.write("levels.yaml", levels(0.1));
    folder_.write("methods.yaml", methods(5));
    folder_.write("plan.yaml", R"(octree_resolution: 0.02
applications:
  - name: bar
    kind: force
    scene: )" + folder_.file("scene.yaml").string() +
                                   R"(
    configuration: rt/config/examples/bar_long_soft.yaml
    method_file: )" + folder_.file("methods.yaml").string() +
                                   R"(
    methods: [pose, spline]
    mismatch_file: )" + folder_.file("levels.yaml").string() +
                                   R"(
    mismatch: [clear, dim]
    seeds: [1]
)");
  }
  /// Two levels of vision on a short motion.
  static std::string levels(double noise) {
    const auto level = [](const std::string& name, double share) {
      return name +
             ":\n  about: vision\n  scene:\n    - \"camera={truth_segmentation: true, eye: [1.1, "
             "-0.7, 0.8]}\"\n" +
             "    - \"sensors.camera={rate: 30, depth: {noise: " + std::to_string(share) + "}}\"\n";
    };
    return level("clear", noise) + level("dim", 1);
  }
  static std::string methods(int controls) {
    return "pose: []\nspline:\n  - \"estimation={component: spline_fit, controls: " +
           std::to_string(controls) +
           "}\"\n  - \"deformation={component: as_rigid_as_possible}\"\n" +
           "  - \"plugins=[{library: palpate-baselines.so}]\"\n";
  }
  int run(const std::string& arguments, const std::string& name = "said.txt") const {
    const std::string command = std::string(PALPATE_BIN_DIR) + "/palpate-evaluate --root '" +
                                kRoot + "' " + arguments + " > '" + folder_.file(name).string() +
                                "' 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int study(const std::string& options = "") const {
    return run("published-sensing --plan '" + folder_.file("plan.yaml").string() + "' --output '" +
               folder_.file("out").string() + "' " + options);
  }
  std::string said() const { return folder_.read("said.txt"); }
  nlohmann::json result(const std::string& job) const {
    return nlohmann::json::parse(folder_.read("out/" + job + "/result.json"));
  }

  studies::StudyFolder folder_;
};

TEST_F(PublishedSensing, RunsAgainWhatHasChangedAndNothingElse) {
  ASSERT_EQ(study(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("recordings: 2 run, 0 kept, 0 failed"));
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 4 run, 0 kept, 0 failed"));
  const nlohmann::json pose = result("bar_pose_clear_1");
  EXPECT_EQ(pose["job"]["seed"], 1);
  EXPECT_FALSE(pose["version"].get<std::string>().empty());
  // The hand has moved by 30 mm, and a shape driven by its pose follows.
  EXPECT_GT(pose["states"][0]["displacement_mm"], 20);
  EXPECT_LT(pose["states"][0]["mean_mm"], 3);
  EXPECT_THAT(folder_.read("out/states.csv"), HasSubstr("spline,dim,1,up"));

  ASSERT_EQ(study(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("recordings: 0 run, 2 kept, 0 failed"));
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 0 run, 4 kept, 0 failed"));

  folder_.write("methods.yaml", methods(6));  // a number of one method
  ASSERT_EQ(study(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("recordings: 0 run, 2 kept, 0 failed"));
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 2 run, 2 kept, 0 failed"));

  folder_.write("levels.yaml", levels(0.2));  // a scene
  ASSERT_EQ(study(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("recordings: 1 run, 1 kept, 0 failed"));
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 2 run, 2 kept, 0 failed"));
}

TEST_F(PublishedSensing, ShardsMakeTheSameReportTogether) {
  ASSERT_EQ(study("--shard 1/2"), 0) << said();
  EXPECT_THAT(said(), HasSubstr("shard 1/2: 2 of 4 jobs"));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("out/report.html")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("out/bar_pose_dim_1")));
  ASSERT_EQ(study("--shard 2/2"), 0) << said();
  ASSERT_EQ(study("--report-only"), 0) << said();
  EXPECT_THAT(folder_.read("out/report.html"), HasSubstr("spline"));
  ASSERT_EQ(study(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 0 run, 4 kept, 0 failed"));
  EXPECT_NE(study("--shard 3/2"), 0);
  EXPECT_THAT(said(), HasSubstr("1 <= I <= N"));
}

TEST_F(PublishedSensing, AMethodThatFailsCountsAtTheCap) {
  std::string broken = methods(5);
  const std::string from = "controls: 5";
  broken.replace(broken.find(from), from.size(), "controls: none");
  folder_.write("methods.yaml", broken);
  EXPECT_EQ(study("--cap 42"), 1) << said();
  EXPECT_THAT(said(), HasSubstr("methods on recordings: 2 run, 0 kept, 2 failed"));
  EXPECT_THAT(said(), HasSubstr("controls"));
  EXPECT_THAT(said(), HasSubstr("42.00 / 42.00"));
}

TEST_F(PublishedSensing, WhatIsControlledIsRefused) {
  EXPECT_EQ(run("published-sensing --plan '" + kRoot +
                "/tools/lab/studies/published_control.yaml' --output '" +
                folder_.file("out").string() + "'"),
            1);
  EXPECT_THAT(said(), HasSubstr("what is controlled cannot be replayed"));
}

TEST_F(PublishedSensing, TrainingLeavesModelsThatPalpatedTakes) {
  folder_.write("training.yaml", R"(seed: 3
units: 6
hidden: 5
epochs: 400
objects:
  - name: bar
    scene: sim/scenes/bar_long_soft_six_poses.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    motion: {poses: 4, translation: [0.01, 0.05, 0.05], rotation_deg: [10, 10, 10]}
)");
  ASSERT_EQ(run("train-sensing --plan '" + folder_.file("training.yaml").string() + "' --output '" +
                folder_.file("trained").string() + "'"),
            0)
      << said();
  for (const char* kind : {"position", "angle"}) {
    const std::string model = "trained/bar_" + std::string(kind) + ".yaml";
    EXPECT_THAT(folder_.read(model), HasSubstr("seed 3"));
    const config::Node root = config::Node::load_file(
        kRoot + "/rt/config/examples/bar_long_soft.yaml",
        {"estimation={component: learned_shape, model: '" + folder_.file(model).string() + "'}",
         "deformation={component: as_rigid_as_possible}",
         "plugins=[{library: palpate-baselines.so}]"});
    EXPECT_NO_THROW(pipeline::Pipeline(root, 1e-3)) << model;
  }
}

}  // namespace
}  // namespace palpate::evaluate
