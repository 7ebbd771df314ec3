// Every example configuration of the daemon is one that it can run.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "rt/component/pipeline.hpp"

namespace palpate::component {
namespace {

constexpr int kMostNodes = 700;  // that a 1 kHz loop is meant for

std::vector<std::string> example_names() {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(PALPATE_SOURCE_DIR "/rt/config/examples"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A force map of zeros in place of a fitted one, which the tree does not hold.
std::string write_tactile_model() {
  const std::string path = ::testing::TempDir() + "/palpate_examples_tactile_model.yaml";
  std::string row = "[0";
  for (int i = 1; i < 21; ++i) row += ", 0";
  row += "]";
  std::ofstream(path) << "model: {force_x: " << row << ", force_y: " << row << ", force_z: " << row
                      << "}\n";
  return path;
}

class EveryExample : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryExample, IsConfiguredAndStarts) {
  const std::string path = PALPATE_SOURCE_DIR "/rt/config/examples/" + GetParam() + ".yaml";
  std::vector<std::string> overrides;
  if (config::Node::load_file(path).list("sensing")[0].has("model_file"))
    overrides.push_back("sensing.0.model_file=" + write_tactile_model());
  Pipeline pipeline(config::Node::load_file(path, overrides), 1e-3);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kInactive) << pipeline.condition().reason;
  const elasticity::Body& body = pipeline.object().body;
  EXPECT_LE(body.mesh.node_count(), kMostNodes);
  EXPECT_TRUE(!body.fixed_nodes.empty() || body.grasps.size() == 2) << "nothing holds it";
  if (!body.grasps.empty()) {
    // G lies within what the hand has hold of.
    const Eigen::Vector3d p = body.grasps[0].X_OG_rest.translation();
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(1e9), upper = -lower;
    for (const int node : body.grasps[0].nodes) {
      lower = lower.cwiseMin(body.mesh.nodes.col(node));
      upper = upper.cwiseMax(body.mesh.nodes.col(node));
    }
    EXPECT_TRUE((p.array() >= lower.array()).all() && (p.array() <= upper.array()).all());
  }
  pipeline.start();
  EXPECT_NE(pipeline.condition().state, LifeCycle::kFaulted) << pipeline.condition().reason;
}

INSTANTIATE_TEST_SUITE_P(Example, EveryExample, ::testing::ValuesIn(example_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace palpate::component
