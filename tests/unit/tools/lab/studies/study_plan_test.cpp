#include "tools/lab/studies/study_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "rt/config/node.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const std::filesystem::path kStudyPlanRoot = PALPATE_SOURCE_DIR;

constexpr const char* kPlan = R"(octree_resolution: 0.01
applications:
  - name: bar
    kind: force
    scene: sim/scenes/bar_long_soft_six_poses.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    methods: [pose-driven, "force-driven, repaired"]
    mismatch: [none, all]
    seeds: [1, 2, 3]
    pose_points: [[0.4655, 0.0297, 0], [0.3875, 0.0297, 0], [0.3625, 0.0303, 0.06]]
    published: [{quantity: "error", value: not available}]
  - name: pull
    kind: control
    scene: sim/scenes/bar_long_soft_control.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    methods: [pose-driven]
    also: {pose-driven: [control.gain=0.5]}
    mismatch: [none]
    seeds: [4]
    duration: 2
    target: {feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]}
)";

class StudyPlanTest : public testing::Test {
 protected:
  StudyPlan read(const std::string& text) const {
    return read_study_plan(folder_.write("plan.yaml", text), kStudyPlanRoot);
  }
  /// Error of the plan after one replacement.
  std::string error_of(const std::string& from, const std::string& to) const {
    std::string text = kPlan;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    try {
      read(text.replace(at, from.size(), to));
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }
  StudyFolder folder_;
};

class OwnPlan : public testing::TestWithParam<const char*> {};

TEST_P(OwnPlan, IsWhole) {
  const StudyPlan plan = read_study_plan(
      kStudyPlanRoot / "tools/lab/studies" / (std::string(GetParam()) + ".yaml"), kStudyPlanRoot);
  const std::vector<StudyJob> jobs = study_jobs(plan, {});
  std::set<std::string> folders, kinds;
  for (const StudyJob& job : jobs) {
    folders.insert(job.name);
    kinds.insert(job.kind);
    EXPECT_GT(job.duration, 0) << job.name;
  }
  EXPECT_EQ(folders.size(), jobs.size());
  const std::string study = GetParam();
  EXPECT_EQ(kinds.count("force"), study == "control" || study == "drawn_control" ? 0u : 1u);
  EXPECT_EQ(kinds.count("control"), study == "estimate" || study == "drawn_sensing" ? 0u : 1u);
}

INSTANTIATE_TEST_SUITE_P(Studies, OwnPlan,
                         testing::Values("thesis", "estimate", "control", "drawn_sensing",
                                         "drawn_control"),
                         [](const auto& study) { return std::string(study.param); });

/// One of our own plans with that many calibrated draws.
StudyPlan plan_of_draws(const std::string& study, int draws,
                        std::optional<int> seed = std::nullopt) {
  LevelSelection selection;
  selection.levels = {"calibrated"};
  selection.draws = draws;
  selection.draw_seed = seed;
  return read_study_plan(kStudyPlanRoot / "tools/lab/studies" / (study + ".yaml"), kStudyPlanRoot,
                         selection);
}

TEST_F(StudyPlanTest, EachDrawHoldsOneObject) {
  const StudyPlan plan = plan_of_draws("drawn_sensing", 10);
  std::multiset<std::string> draws;
  for (const StudyApplication& application : plan.applications) {
    if (application.name.find("six poses") != 0) continue;
    EXPECT_GE(application.levels.size(), 2u) << application.name;
    for (const runs::Mismatch& level : application.levels) draws.insert(level.name);
  }
  ASSERT_EQ(draws.size(), 10u);
  EXPECT_EQ(std::set<std::string>(draws.begin(), draws.end()).size(), 10u);
}

TEST_F(StudyPlanTest, ObjectOutsideOfThoseDrawnIsRefused) {
  for (const char* wrong : {"[3, 2]", "[1.5, 2]", "[0, 2]"})
    EXPECT_THAT(error_of("mismatch: [none]",
                         "drawn_object: " + std::string(wrong) + "\n    mismatch: [none]"),
                HasSubstr("drawn_object"))
        << wrong;
}

TEST_F(StudyPlanTest, ForceBasedSensingIsOfBarAndBlockSoftAndHard) {
  const StudyPlan plan =
      read_study_plan(kStudyPlanRoot / "tools/lab/studies/thesis.yaml", kStudyPlanRoot);
  const auto application_of = [&plan](const std::string& scene) {
    return std::find_if(plan.applications.begin(), plan.applications.end(),
                        [&scene](const auto& a) { return a.scene.stem() == scene; });
  };
  for (const char* object : {"bar_long_soft", "bar_long_hard", "block_soft", "block_hard"}) {
    const auto main = application_of(object + std::string("_six_poses"));
    ASSERT_NE(main, plan.applications.end()) << object;
    EXPECT_EQ(main->configuration.stem(), object);
    EXPECT_EQ(main->methods.size(), 3u) << object;
    EXPECT_EQ(main->levels.size(), 1u) << object;
    EXPECT_EQ(main->pose_points.size(), 3u) << object;
    const auto published = application_of(object + std::string("_six_poses_thesis"));
    ASSERT_NE(published, plan.applications.end()) << object;
    EXPECT_FALSE(published->quick) << object;
  }
}

TEST_F(StudyPlanTest, EachModelErrorStandsAlone) {
  const StudyPlan plan =
      read_study_plan(kStudyPlanRoot / "tools/lab/studies/model_error.yaml", kStudyPlanRoot);
  std::set<std::vector<std::string>> changes;
  for (const StudyJob& job : study_jobs(plan, {})) {
    std::vector<std::string> change = job.scene_overrides;
    change.insert(change.end(), job.daemon_overrides.begin(), job.daemon_overrides.end());
    EXPECT_TRUE(changes.insert(change).second) << job.name;
  }
  EXPECT_EQ(changes.size(), 2u * 7);
}

TEST_F(StudyPlanTest, EveryMethodLevelAndSeedIsAJob) {
  const std::vector<StudyJob> jobs = study_jobs(read(kPlan), {});
  ASSERT_EQ(jobs.size(), 2u * 2 * 3 + 1);
  EXPECT_THAT(jobs[0].scene_overrides, Contains("seed=1"));
  EXPECT_THAT(jobs[0].daemon_overrides, Contains("feature.component=pose"));
  EXPECT_GT(jobs[0].duration, 20);  // six poses of two seconds, and the moves between them
  EXPECT_THAT(jobs[0].pose_names, testing::ElementsAre("P1", "P2", "P3", "P4", "P5", "P6"));
  const StudyJob& control = jobs.back();
  EXPECT_EQ(control.duration, 2);
  ASSERT_TRUE(control.target);
  EXPECT_LT((control.target->values - Eigen::Vector3d(0.25, 0.03, 0.07)).norm(), 1e-12);
  EXPECT_THAT(control.daemon_overrides,
              AllOf(Contains("feature.component=point"), Contains("control.gain=0.5")));
}

TEST_F(StudyPlanTest, ATargetIsAPlaceOrWhatAHandMotionReaches) {
  std::string text = kPlan;
  const std::string from = "displacement: [0, 0, 0.01]";
  text.replace(text.find(from), from.size(), "hand: {translation: [0, 0, 0.1]}");
  const std::string point = "feature: point, rest_points: [[0.25, 0.03, 0.06]]";
  text.replace(text.find(point), point.size(),
               "feature: points, rest_points: [[0.25, 0.03, 0.06], [0.3, 0.03, 0.06]]");
  StudyJob job = study_jobs(read(text), {}).back();
  ASSERT_TRUE(job.target && job.target->hand);
  EXPECT_EQ(job.target->hand->translation, Eigen::Vector3d(0, 0, 0.1));
  EXPECT_EQ(job.target->hand->rotation_deg, Eigen::Vector3d::Zero());
  EXPECT_THAT(job.daemon_overrides, Contains("feature.component=points"));
  const std::string before = hash_of_inputs(job, {});
  job.target->hand->rotation_deg.x() = 1;
  EXPECT_NE(hash_of_inputs(job, {}), before);
  EXPECT_THAT(error_of(from, from + ", hand: {translation: [0, 0, 0.1]}"),
              HasSubstr("applications.1.target.displacement"));
}

TEST_F(StudyPlanTest, AnAngleHasAnAxisAndATargetThatTheHandReaches) {
  const std::string point =
      "feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]";
  const std::string angle =
      "feature: angle, axis: [0, -1, 0], rest_points: [[0.1, 0.03, 0.03], [0.2, 0.03, 0.03], [0.3, "
      "0.03, 0.03]], ";
  std::string text = kPlan;
  text.replace(text.find(point), point.size(), angle + "hand: {translation: [0, 0, 0.1]}");
  const StudyJob job = study_jobs(read(text), {}).back();
  ASSERT_TRUE(job.target && job.target->axis);
  EXPECT_EQ(*job.target->axis, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(job.target->values.size(), 1);
  EXPECT_THAT(job.daemon_overrides, Contains("feature.axis=[0, -1, 0]"));
  EXPECT_THAT(error_of(point, angle + "displacement: [0, 0, 0.01]"),
              HasSubstr("applications.1.target.hand: is needed"));
}

TEST_F(StudyPlanTest, ASelectionChooses) {
  const StudyPlan plan = read(kPlan);
  StudySelection selection;
  selection.applications = {"pull"};
  selection.seeds = {7, 8};
  const std::vector<StudyJob> jobs = study_jobs(plan, selection);
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[1].seed, 8);
  selection.applications = {"sponge"};
  EXPECT_THROW(study_jobs(plan, selection), std::invalid_argument);
}

TEST_F(StudyPlanTest, AQuickRunIsOneSeedOfWhatThePlanDoesNotLeaveOut) {
  std::string text = kPlan;
  text.replace(text.find("seeds: [4]"), 10, "seeds: [4]\n    quick: false\n    note: too soft");
  const StudyPlan plan = read(text);
  EXPECT_EQ(plan.applications[1].note, "too soft");
  StudySelection selection;
  selection.quick = true;
  const std::vector<StudyJob> jobs = study_jobs(plan, selection);
  ASSERT_EQ(jobs.size(), 2u * 2);
  for (const StudyJob& job : jobs) {
    EXPECT_EQ(job.application, "bar");
    EXPECT_EQ(job.seed, 1);
  }
  selection.applications = {"pull"};
  EXPECT_THROW(study_jobs(plan, selection), std::invalid_argument);
}

TEST_F(StudyPlanTest, AModelErrorIsRelativeToTheObject) {
  std::string text = kPlan;
  const std::string soft = "rt/config/examples/bar_long_soft.yaml";
  const std::vector<StudyJob> bar = study_jobs(read(text), {});
  EXPECT_THAT(bar[2].daemon_overrides, AllOf(Contains("object.material.young_modulus=39000"),
                                             Contains("object.mesh.box.cells=[7, 1, 1]")));
  EXPECT_THAT(bar[2].scene_overrides, Contains("object.pads.stiffness=20000"));
  const std::string hard = "rt/config/examples/bar_long_hard.yaml";
  text.replace(text.find(soft), soft.size(),
               hard + "\n    also: {all: ['object.mesh.box.cells=[5, 1, 1]']}");
  const std::vector<std::string> overrides = study_jobs(read(text), {})[2].daemon_overrides;
  EXPECT_THAT(overrides, Contains("object.material.young_modulus=78000"));
  const auto coarse =
      std::find(overrides.begin(), overrides.end(), "object.mesh.box.cells=[7, 1, 1]");
  ASSERT_NE(coarse, overrides.end());
  EXPECT_NE(std::find(coarse, overrides.end(), "object.mesh.box.cells=[5, 1, 1]"), overrides.end());
}

TEST_F(StudyPlanTest, ErrorsNameFileAndKey) {
  EXPECT_THAT(error_of("kind: force", "kind: push"),
              AllOf(HasSubstr("plan.yaml:4"), HasSubstr("applications.0.kind")));
  EXPECT_THAT(error_of("sim/scenes/bar_long_soft_six_poses.yaml", "sim/scenes/none.yaml"),
              AllOf(HasSubstr("plan.yaml"), HasSubstr("applications.0.scene")));
  EXPECT_THAT(
      error_of("methods: [pose-driven,", "methods: [by magic,"),
      AllOf(HasSubstr("applications.0.methods"), HasSubstr("by magic"), HasSubstr("pose-driven")));
  EXPECT_THAT(error_of("mismatch: [none]", "mismatch: [some]"),
              AllOf(HasSubstr("mismatch.yaml"), HasSubstr("some")));
  EXPECT_THAT(error_of("mismatch: [none]", "mismatch: [none, none]"),
              HasSubstr("applications.1.mismatch"));
  EXPECT_THAT(error_of("seeds: [4]", "seeds: [4.5]"), HasSubstr("applications.1.seeds"));
  EXPECT_THAT(error_of("seeds: [4]", "seeds: []"), HasSubstr("applications.1.seeds"));
  EXPECT_THAT(error_of("    duration: 2\n", ""), HasSubstr("applications.1.duration"));
  EXPECT_THAT(error_of("feature: point", "feature: pose"),
              HasSubstr("applications.1.target.rest_points"));
  EXPECT_THAT(error_of("published:", "publishd:"), HasSubstr("publishd"));
  EXPECT_THAT(error_of("{pose-driven: [control.gain", "{by magic: [control.gain"),
              AllOf(HasSubstr("applications.1.also.by magic"), HasSubstr("no method")));
  EXPECT_THAT(error_of("[control.gain=0.5]", "[control.gain]"), HasSubstr("key=value"));
  EXPECT_THAT(error_of("name: pull", "name: bar"), HasSubstr("applications.1.name"));
  EXPECT_THAT(error_of("resolution: 0.01", "resolution: 0"), HasSubstr("octree_resolution"));
}

TEST_F(StudyPlanTest, ADistributionStandsForItsDraws) {
  std::string text = kPlan;
  const std::string from = "mismatch: [none, all]";
  text.replace(text.find(from), from.size(),
               "mismatch: [none, calibrated, uncalibrated 2]\n    draws: 4\n    draw_seed: 3\n"
               "    also: {calibrated: ['object.mesh.box.cells=[5, 1, 1]']}");
  const StudyPlan plan = read(text);
  const StudyApplication& bar = plan.applications[0];
  ASSERT_EQ(bar.levels.size(), 1u + 4 + 1);
  EXPECT_EQ(bar.levels[0].family, "");
  EXPECT_EQ(bar.levels[4].name, "calibrated 4");
  EXPECT_EQ(bar.levels[4].family, "calibrated");
  EXPECT_EQ(bar.levels[4].daemon.back(), "object.mesh.box.cells=[5, 1, 1]");
  EXPECT_EQ(bar.levels[5].name, "uncalibrated 2");
  EXPECT_THAT(level_names(bar), testing::ElementsAre("none", "calibrated", "uncalibrated"));
  std::set<std::string> hashes;
  const std::vector<StudyJob> jobs = study_jobs(plan, {});
  ASSERT_EQ(jobs.size(), 2u * 6 * 3 + 1);
  for (const StudyJob& job : jobs) hashes.insert(hash_of_inputs(job, {}));
  EXPECT_EQ(hashes.size(), jobs.size());
  EXPECT_EQ(jobs[2].family, "calibrated");
  EXPECT_FALSE(jobs[2].drawn.empty());
}

TEST_F(StudyPlanTest, DrawsReplaceThePlansModelErrors) {
  const StudyPlan plan = plan_of_draws("estimate", 2);
  for (const StudyApplication& application : plan.applications) {
    ASSERT_EQ(application.levels.size(), 2u) << application.name;
    EXPECT_EQ(application.levels[1].name, "calibrated 2");
  }
  EXPECT_NE(plan_of_draws("estimate", 2, 9).applications[0].levels[0].scene,
            plan.applications[0].levels[0].scene);
}

TEST_F(StudyPlanTest, DrawsThatDoNotExistAreRefused) {
  for (const char* wrong : {"calibrated 5", "calibrated 0", "calibrate", "calibrated x"})
    EXPECT_THAT(
        error_of("mismatch: [none]", "draws: 4\n    mismatch: [" + std::string(wrong) + "]"),
        HasSubstr(wrong))
        << wrong;
}

class StudyHash : public StudyPlanTest {
 protected:
  /// A plan whose scene and configuration lie in the folder and name a file.
  std::string hash(const std::string& scene, const std::string& configuration, int seed = 1,
                   const std::string& program = "p") const {
    StudyJob job;
    job.scene = folder_.write("scene.yaml", scene);
    job.configuration = folder_.write("configuration.yaml", configuration);
    job.seed = seed;
    job.scene_overrides = {"seed=" + std::to_string(seed)};
    return hash_of_inputs(job, {program});
  }
};

TEST_F(StudyHash, ChangesWithEveryInputAndNothingElse) {
  folder_.write("arm.urdf", "one");
  const std::string scene = "robot: {urdf: arm.urdf}\n", settings = "loop: {period_ms: 1}\n";
  const std::string before = hash(scene, settings);
  EXPECT_EQ(hash(scene, settings), before);
  EXPECT_EQ(hash("# a remark\n" + scene, settings), before);
  EXPECT_NE(hash(scene + "a: 1\n", settings), before);
  EXPECT_NE(hash(scene, "loop: {period_ms: 2}\n"), before);
  EXPECT_NE(hash(scene, settings, 2), before);
  EXPECT_NE(hash(scene, settings, 1, "q"), before);
  folder_.write("arm.urdf", "two");
  EXPECT_NE(hash(scene, settings), before);
}

TEST_F(StudyHash, ChangesWithAFileThatAnOverrideNames) {
  StudyJob job;
  job.scene = folder_.write("scene.yaml", "a: 1\n");
  job.configuration = folder_.write("configuration.yaml", "estimation: {component: none}\n");
  job.daemon_overrides = {"estimation={component: learned_shape, model: model.yaml}"};
  folder_.write("model.yaml", "weights: [1]");
  const std::string before = hash_of_inputs(job, {});
  folder_.write("model.yaml", "weights: [2]");
  EXPECT_NE(hash_of_inputs(job, {}), before);
}

TEST_F(StudyHash, OfTheJobItself) {
  std::vector<StudyJob> jobs = study_jobs(read(kPlan), {});
  std::set<std::string> hashes;
  for (const StudyJob& job : jobs) hashes.insert(hash_of_inputs(job, {}));
  EXPECT_EQ(hashes.size(), jobs.size());
  StudyJob control = jobs.back();
  control.target->values[2] += 0.001;
  hashes.insert(hash_of_inputs(control, {}));
  control.real_time = true;
  hashes.insert(hash_of_inputs(control, {}));
  EXPECT_EQ(hashes.size(), jobs.size() + 2);
}

}  // namespace
}  // namespace palpate::studies
