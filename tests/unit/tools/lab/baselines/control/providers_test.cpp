// Published controllers in the daemon's pipeline: each can be configured, none allocates in the
// loop, and observed markers replace the model's feature.

#include <gtest/gtest.h>

#include "rt/loop/allocation_counter.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "rt/plugin/plugins.hpp"

namespace palpate::baselines {
namespace {

const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

const std::string kLibrary = "plugins=[{library: palpate-baselines.so}]";

/// Names of the library's providers.
std::vector<std::string> published_providers() {
  std::vector<std::string> names;
  const auto plugins = plugin::Plugins::load(config::Node::load_file(kExample, {kLibrary}));
  for (const auto& entry : plugins->components().jacobian_providers.entries())
    names.push_back(entry.name);
  return names;
}

std::string error_of(std::vector<std::string> overrides) {
  overrides.push_back(kLibrary);
  try {
    const config::Node root = config::Node::load_file(kExample, overrides);
    const pipeline::Pipeline pipeline(root, 1e-3);
    root.child("control").check_all_used();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

class PublishedControlRegistry : public ::testing::Test {
 protected:
  void build(std::vector<std::string> overrides) {
    overrides.emplace_back("sensing=[]");
    overrides.push_back(kLibrary);
    pipeline_ =
        std::make_unique<pipeline::Pipeline>(config::Node::load_file(kExample, overrides), 1e-3);
    const registry::Frames& frames = pipeline_->frames(0);
    signals_ = {};
    signals_.robot.freshness = Freshness::kNew;
    signals_.robot.age = 0;
    signals_.robot.latest.X_WE =
        frames.X_WO * pipeline_->object().body.grasps[0].X_OG_rest * frames.X_EG.inverse();
    pipeline_->start();
  }

  /// Allocations of the loop's part in this many cycles.
  std::int64_t run(int cycles) {
    std::int64_t allocations = 0;
    for (int i = 0; i < cycles; ++i) {
      const loop::NoAllocationScope scope;
      pipeline_->sense(signals_);
      pipeline_->distribute();
      pipeline_->estimate(1e-3);
      pipeline_->evaluate_feature();
      pipeline_->control(1e-3);
      pipeline_->gate(1e-3);
      allocations += scope.count();
      signals_.observation.freshness = Freshness::kOld;
      signals_.observation.age += 1e-3;
    }
    return allocations;
  }

  void aim(const Eigen::Vector3d& way) {
    const Eigen::VectorXd target = pipeline_->feature_state().value + way;
    const char* reason = "";
    ASSERT_TRUE(pipeline_->set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  }

  /// A marker at the feature's point, displaced.
  void see(const Eigen::Vector3d& displacement) {
    sensing::ShapeObservation& seen = signals_.observation.latest;
    signals_.observation.freshness = Freshness::kNew;
    signals_.observation.age = 0;
    seen.count = 1;
    seen.deviation = 1e-6;
    const Eigen::Vector3d p = Eigen::Vector3d(0.25, 0.03, 0.06) + displacement;
    seen.points_W.col(0) = (pipeline_->frames(0).X_WO * p).cast<float>();
  }

  double speed() const { return pipeline_->gate_output(0).V_W_E.linear.norm(); }

  std::unique_ptr<pipeline::Pipeline> pipeline_;
  sensing::Signals signals_;
};

TEST_F(PublishedControlRegistry, EachIsBuiltMovesTheHandAndAllocatesNothing) {
  ASSERT_GE(published_providers().size(), 16u);
  for (const std::string& name : published_providers()) {
    std::vector<std::string> overrides{"control.provider=" + name};
    if (name.find("inverse_elements") == 0 || name == "rheological_chain")
      overrides.emplace_back("control.goal={displacement: [0, 0, 0.03]}");
    if (name == "inverse_elements_force")  // required by it and missing in the test
      overrides.emplace_back("control.filter=0.1");
    EXPECT_EQ(error_of(overrides), "") << name;
    build(overrides);
    run(50);
    aim({0, 0, 0.03});
    const std::int64_t allocations = run(200);
    EXPECT_EQ(allocations, 0) << name;
    if (name != "inverse_elements_force") {
      EXPECT_GT(speed(), 1e-5) << name;
    }
    EXPECT_EQ(pipeline_->condition().state, pipeline::LifeCycle::kActive)
        << name << ": " << pipeline_->condition().reason;
  }
}

TEST_F(PublishedControlRegistry, WrongKeysAreNamed) {
  const std::string unknown = error_of({"control.provider=oracle"});
  EXPECT_NE(unknown.find("oracle"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("weighted_least_squares"), std::string::npos) << unknown;
  EXPECT_NE(error_of({"control.provider=broyden", "control.update_gain=2"}).find("update_gain"),
            std::string::npos);
  EXPECT_NE(error_of({"control.provider=gaussian_process", "control.samples=2"}).find("samples"),
            std::string::npos);
  EXPECT_NE(error_of({"control.provider=inverse_elements_force"}).find("goal"), std::string::npos);
  EXPECT_NE(error_of({"control.vision=crystal_ball"}).find("markers_and_model"), std::string::npos);
  EXPECT_NE(error_of({"control.provider=rheological_chain", "control.masses=3",
                      "control.goal={displacement: [0, 0, 0.03]}"})
                .find("masses"),
            std::string::npos);
  EXPECT_NE(error_of({"control.provider=reach_then_deform", "control.reach={tip: [0, 0, 0]}"})
                .find("place"),
            std::string::npos);
  const std::string pose = error_of(
      {"control.provider=broyden",
       "feature={component: pose, rest_points: [[0.4655, 0.0297, 0], [0.3875, 0.0297, 0], [0.3625, "
       "0.0303, 0.06]]}"});
  EXPECT_NE(pose.find("pose cannot be learnt"), std::string::npos) << pose;
}

TEST_F(PublishedControlRegistry, MarkersSayWhereTheFeatureIs) {
  build({"control.vision=markers"});
  run(50);
  aim({0, 0, 0.03});
  run(50);
  EXPECT_EQ(speed(), 0) << "nothing has been seen yet";
  see({0, 0, 0.01});
  EXPECT_EQ(run(50), 0);
  EXPECT_NEAR(pipeline_->feature_state().value.z(), 0.07, 1e-6);
  EXPECT_GT(speed(), 1e-3);
  run(500);
  EXPECT_EQ(speed(), 0) << "the markers are lost";
  EXPECT_STREQ(pipeline_->condition().reason, "the markers are not seen");
  see({0, 0, 0.01});
  run(50);
  EXPECT_GT(speed(), 1e-3);
}

TEST_F(PublishedControlRegistry, WithTheModelAFeatureOutlivesItsMarkers) {
  build({"control.vision=markers_and_model"});
  run(50);
  aim({0, 0, 0.03});
  const double before = pipeline_->feature_state().value.z();
  see({0, 0, before - 0.06 + 0.01});
  run(1000);
  EXPECT_NEAR(pipeline_->feature_state().value.z(), before + 0.01, 2e-3);
  EXPECT_GT(speed(), 1e-3);
}

}  // namespace
}  // namespace palpate::baselines
