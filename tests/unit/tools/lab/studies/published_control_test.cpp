// The study of published controllers is consistent: every method is tuned, documented, and accepted
// by palpated; markers are at the targets' points.

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <set>

#include "rt/pipeline/pipeline.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {
namespace {

const std::filesystem::path kRoot = PALPATE_SOURCE_DIR;

StudyPlan plan() {
  return read_study_plan(kRoot / "tools/lab/studies/published_control.yaml", kRoot);
}

std::set<std::string> keys(const YAML::Node& node) {
  std::set<std::string> names;
  for (const auto& entry : node) names.insert(entry.first.Scalar());
  return names;
}

TEST(PublishedControl, EveryMethodIsTunedWithinTheSameBudgetAndHasItsPage) {
  const YAML::Node tuning = YAML::LoadFile(kRoot / "tools/lab/studies/tuning.yaml");
  const YAML::Node about =
      YAML::LoadFile(kRoot / "tools/lab/studies/published_control_methods.yaml");
  const std::set<std::string> tuned = keys(tuning["tasks"][0]["methods"]),
                              pages = keys(about["methods"]);
  const std::set<std::string> first =
      keys(YAML::LoadFile(kRoot / "tools/lab/studies/baselines.yaml"));
  for (const StudyApplication& application : plan().applications) {
    std::set<std::string> methods;
    for (const runs::Method& method : application.methods) methods.insert(method.name);
    // An object that is not held causes no wrench at the wrist.
    if (application.name.find("not touched") != std::string::npos) {
      EXPECT_TRUE(methods.insert("palpate, pose and wrench").second) << application.name;
    }
    EXPECT_EQ(methods, tuned) << application.name;
    EXPECT_EQ(methods, pages) << application.name;
    EXPECT_EQ(methods, first) << application.name;
  }
  for (const std::string& method : pages) {
    const YAML::Node page = about["methods"][method];
    for (const char* key : {"row", "source", "consumes", "keeps", "leaves out"})
      EXPECT_TRUE(page[key]) << method << ": " << key;
    std::istringstream sources(page["source"].Scalar());
    for (std::string source; std::getline(sources >> std::ws, source, ',');)
      EXPECT_TRUE(std::filesystem::exists(kRoot / source)) << method << ": " << source;
  }
}

TEST(PublishedControl, EveryRowOfTheTableHasAMethodOrAReason) {
  const YAML::Node about =
      YAML::LoadFile(kRoot / "tools/lab/studies/published_control_methods.yaml");
  std::set<std::string> rows;
  for (const auto& entry : about["methods"]) rows.insert(entry.second["row"].Scalar());
  for (const YAML::Node& entry : about["no score"]) {
    rows.insert(entry["row"].Scalar());
    EXPECT_GT(entry["reason"].Scalar().size(), 30u);
  }
  for (const char* row :
       {"41", "43", "44", "45", "46", "47", "48", "49", "50", "51", "52", "53", "54", "thesis"})
    EXPECT_EQ(rows.count(row), 1u) << row;
}

TEST(PublishedControl, MarkersSitOnWhatIsSteered) {
  std::set<std::string> seeing;
  for (const StudyApplication& application : plan().applications) {
    for (const runs::Mismatch& level : application.levels) {
      const scenes::Scene scene =
          scenes::read_scene(config::Node::load_file(application.scene.string(), level.scene));
      ASSERT_TRUE(scene.markers) << application.name;
      ASSERT_EQ(scene.markers->rest_points.size(), application.target->rest_points.size());
      for (std::size_t i = 0; i < scene.markers->rest_points.size(); ++i)
        EXPECT_EQ(scene.markers->rest_points[i], application.target->rest_points[i]);
      const bool blind = level.name == "blind";
      EXPECT_EQ(scene.markers->timing.drop_out == 1, blind) << level.name;
      if (!blind) seeing.insert(level.name);
    }
  }
  EXPECT_THAT(seeing, testing::ElementsAre("noisy vision", "occluded vision", "perfect vision"));
}

TEST(PublishedControl, PalpatedTakesEveryMethod) {
  StudySelection selection;
  selection.seeds = {1};
  selection.applications = {"contour"};
  for (const StudyJob& job : study_jobs(plan(), selection)) {
    if (job.mismatch != "noisy vision") continue;
    std::vector<std::string> overrides = job.daemon_overrides;
    if (job.method.find("inverse") == 0 || job.method.find("rheological") == 0)
      overrides.emplace_back("control.goal={displacement: [0, 0, 0.01]}");
    try {
      const config::Node root = config::Node::load_file(job.configuration.string(), overrides);
      const pipeline::Pipeline pipeline(root, 1e-3);
      root.child("control").check_all_used();
    } catch (const config::Error& error) {
      ADD_FAILURE() << job.method << ": " << error.what();
    }
  }
}

}  // namespace
}  // namespace palpate::studies
