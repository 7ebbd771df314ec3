// Valid configurations of the pipeline, and error messages for invalid ones.

#include <gtest/gtest.h>

#include <string>

#include "rt/pipeline/pipeline.hpp"

namespace palpate::pipeline {
namespace {

std::string pipeline_configuration_error_of(const std::vector<std::string>& overrides) {
  try {
    const config::Node root = config::Node::load_file(
        PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml", overrides);
    const Pipeline pipeline(root, 1e-3);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(PipelineConfiguration, UnknownComponentsAreNamedWithTheKnownOnes) {
  for (const char* key :
       {"sensing.0.component", "contact.0.component", "estimation.component",
        "deformation.component", "feature.component", "control.provider", "control.law"}) {
    const std::string error =
        pipeline_configuration_error_of({std::string(key) + "=no_such_thing"});
    EXPECT_NE(error.find("no_such_thing"), std::string::npos) << key << ": " << error;
    EXPECT_NE(error.find(key), std::string::npos) << key << ": " << error;
    EXPECT_NE(error.find("allowed"), std::string::npos) << key << ": " << error;
  }
}

TEST(PipelineConfiguration, KeysOfWhatIsSeenAreKeptInTheirRanges) {
  const auto with = [](const char* key, const char* value) {
    return pipeline_configuration_error_of({"estimation.component=pose_wrench_filter",
                                            std::string("estimation.") + key + "=" + value});
  };
  const struct {
    const char *key, *good, *bad;
  } keys[] = {{"observation_lag_ms", "40", "251"},
              {"observation_lag_deviation_ms", "2", "0"},
              {"surface_deviation", "0", "-1"},
              {"surface_correlation_s", "1", "0"},
              {"observation_gate", "4", "0.5"},
              {"observation_reach", "0.05", "0"},
              {"observation_points_per_tick", "256", "257"},
              {"shape_deviation", "0.01", "0"},
              {"observation_fade_ms", "300", "0"},
              {"shape_memory_s", "10", "0"}};
  for (const auto& key : keys) {
    EXPECT_EQ(with(key.key, key.good), "");
    EXPECT_NE(with(key.key, key.bad).find(key.key), std::string::npos) << key.key;
  }
}

TEST(PipelineConfiguration, MissingMeshIsNamed) {
  const std::string error = pipeline_configuration_error_of({"object.mesh={file: nowhere.msh}"});
  EXPECT_NE(error.find("nowhere.msh"), std::string::npos) << error;
}

TEST(PipelineConfiguration, MeshesBeyondAnyLoopAreRefusedBeforeTheyAreMade) {
  const std::string error = pipeline_configuration_error_of(
      {"object.mesh={box: {size: [1, 1, 1], cells: [200, 99, 5]}}"});
  EXPECT_NE(error.find("cells: the mesh would have 120600 nodes"), std::string::npos) << error;
  // 41004 corners and the middles of their edges.
  const std::string middles = pipeline_configuration_error_of(
      {"object.mesh={box: {size: [1, 1, 1], cells: [200, 50, 3]}}"});
  EXPECT_NE(middles.find("order: the mesh would have"), std::string::npos) << middles;
}

TEST(PipelineConfiguration, OutOfRangeMaterialIsNamedWithItsRange) {
  const std::string error = pipeline_configuration_error_of({"object.material.poisson_ratio=0.5"});
  EXPECT_NE(error.find("poisson_ratio"), std::string::npos) << error;
  EXPECT_NE(error.find("0.4999"), std::string::npos) << error;
}

TEST(PipelineConfiguration, GraspBoxWithoutNodesIsRefused) {
  EXPECT_NE(
      pipeline_configuration_error_of({"object.grasp_box={lower: [9, 9, 9], upper: [10, 10, 10]}"}),
      "");
}

TEST(PipelineConfiguration, FallbacksAreCheckedAsTheSlotsAre) {
  EXPECT_NE(pipeline_configuration_error_of({"deformation.fallback={component: no_such_thing}"})
                .find("no_such_thing"),
            std::string::npos);
  EXPECT_NE(pipeline_configuration_error_of(
                {"deformation.fallback={component: corotational_dynamic, pity: 1}"})
                .find("pity"),
            std::string::npos);
  EXPECT_EQ(
      pipeline_configuration_error_of({"deformation.fallback={component: corotational_dynamic}"}),
      "");
}

}  // namespace
}  // namespace palpate::pipeline
