// The library's deformation model, as a configuration loads it.

#include <gtest/gtest.h>

#include "rt/loop/allocation_counter.hpp"
#include "rt/plugin/plugins.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::baselines {
namespace {

std::unique_ptr<elasticity::DeformationModel> build(const std::string& deformation) {
  const config::Node root = config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml",
      {"deformation=" + deformation, "plugins=[{library: palpate-baselines.so}]"});
  registry::Context context;
  context.frames = registry::read_frames(root);
  context.plugins = plugin::Plugins::load(root);
  const registry::Object object = registry::read_object(root, context.frames);
  context.object = &object;
  const config::Node node = root.child("deformation");
  auto model = registry::make_deformation_model(node, context);
  node.check_all_used();
  return model;
}

std::string error_of(const std::string& deformation) {
  try {
    build(deformation);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(PluggedModel, TakesItsKeys) {
  const auto model = build("{component: as_rigid_as_possible, iterations: 7, accuracy: 0}");
  model->prepare();
  model->hold(0, math::Pose(Eigen::Translation3d(0.01, 0, 0)) * model->body().grasps[0].X_OG_rest);
  EXPECT_EQ(model->step(1e-3).iterations, 7);
}

TEST(PluggedModel, NamesWrongKeys) {
  for (const auto& [deformation, key] :
       {std::pair("{component: as_rigid_as_possible, tolerance: 1e-6}", "tolerance"),
        std::pair("{component: as_rigid_as_possible, iterations: 0}", "iterations")}) {
    const std::string error = error_of(deformation);
    EXPECT_NE(error.find(key), std::string::npos) << deformation << ": " << error;
  }
}

TEST(PluggedModel, AllocatesNothingInTheLoop) {
  const auto model = build("{component: as_rigid_as_possible}");
  model->prepare();
  const math::Pose rest = model->body().grasps[0].X_OG_rest;
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 20; ++i) {
    model->hold(0, math::Pose(Eigen::Translation3d(0, 0, 2e-4 * i)) * rest);
    model->step(1e-3);
  }
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::baselines
