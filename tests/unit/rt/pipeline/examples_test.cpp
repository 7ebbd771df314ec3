// Every example configuration of the daemon is valid and runs.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "rt/inference/model_file.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::pipeline {
namespace {

constexpr int kMostNodes = 700;  // for which a 1 kHz loop is designed

std::vector<std::string> example_names() {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(PALPATE_SOURCE_DIR "/rt/config/examples"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A force map of zeros instead of a fitted one, which is not in the tree.
std::string write_tactile_model(const std::filesystem::path& folder) {
  const std::string path = folder / "tactile_model.yaml";
  std::string row = "[0";
  for (int i = 1; i < 21; ++i) row += ", 0";
  row += "]";
  std::ofstream(path) << "model: {force_x: " << row << ", force_y: " << row << ", force_z: " << row
                      << "}\n";
  return path;
}

/// A network of zeros, likewise.
std::string write_force_network(const std::filesystem::path& folder) {
  const std::string path = folder / "force.pt";
  inference::ModelCard card;
  card.name = "zeros";
  card.rate = 100;
  card.inputs = {{"pdc", "count"}};
  card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
  inference::write_model_file(path, sensing::RecurrentWeights::zero(1, 3, {2}), card);
  return path;
}

/// An observer of zeros, likewise.
std::string write_observer_network(const std::filesystem::path& folder) {
  const std::string path = folder / "observer.pt";
  inference::ModelCard card;
  card.name = "zeros";
  card.rate = 200;
  card.inputs = {{"gravity_x", "1"}};
  card.outputs = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                  {"tx", "N m"}, {"ty", "N m"}, {"tz", "N m"}};
  card.payload = sensing::PayloadParameters{};
  inference::write_model_file(path, sensing::RecurrentWeights::zero(1, 6, {2}), card);
  return path;
}

/// Replacement of an example's sensor model that is not in the tree.
std::vector<std::string> stand_ins(const std::string& path, const std::filesystem::path& folder) {
  const config::Node sensor = config::Node::load_file(path).list("sensing")[0];
  if (!sensor.has("model_file")) return {};
  const std::string component = sensor.text("component");
  return {"sensing.0.model_file=" + (component == "biotac_lstm" ? write_force_network(folder)
                                     : component == "ft_rnnob"  ? write_observer_network(folder)
                                                                : write_tactile_model(folder))};
}

class EveryExample : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryExample, IsConfiguredAndStarts) {
  const std::string path = PALPATE_SOURCE_DIR "/rt/config/examples/" + GetParam() + ".yaml";
#ifdef PALPATE_WITHOUT_TORCH
  if (GetParam() == "foam_bar_tactile_lstm" || GetParam() == "payload_arm_rnnob")
    GTEST_SKIP() << "this build has no libtorch";
#endif
  const support::ScratchFolder folder;
  Pipeline pipeline(config::Node::load_file(path, stand_ins(path, folder.path())), 1e-3);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kInactive) << pipeline.condition().reason;
  if (!pipeline.has_object()) return;
  const elasticity::Body& body = pipeline.object().body;
  EXPECT_LE(body.mesh.node_count(), kMostNodes);
  EXPECT_TRUE(!body.fixed_nodes.empty() || !body.grasps.empty()) << "nothing holds it";
  if (!body.grasps.empty()) {
    // G lies within the grasped part.
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
}  // namespace palpate::pipeline
