// The library's deformation model, as a configuration loads it.

#include <gtest/gtest.h>

#include "rt/loop/allocation_counter.hpp"
#include "tests/support/configured_model.hpp"

namespace palpate::baselines {
namespace {

constexpr const char* kLibrary = "palpate-baselines.so";

TEST(PluggedModel, TakesItsKeys) {
  const auto model = support::configured_model(
      "{component: as_rigid_as_possible, iterations: 7, accuracy: 0}", kLibrary);
  model->prepare();
  model->hold(0, math::Pose(Eigen::Translation3d(0.01, 0, 0)) * model->body().grasps[0].X_OG_rest);
  EXPECT_EQ(model->step(1e-3).iterations, 7);
}

TEST(PluggedModel, NamesWrongKeys) {
  for (const auto& [deformation, key] :
       {std::pair("{component: as_rigid_as_possible, tolerance: 1e-6}", "tolerance"),
        std::pair("{component: as_rigid_as_possible, iterations: 0}", "iterations")}) {
    const std::string error = support::configuration_error(deformation, kLibrary);
    EXPECT_NE(error.find(key), std::string::npos) << deformation << ": " << error;
  }
}

TEST(PluggedModel, AllocatesNothingInTheLoop) {
  const auto model = support::configured_model("{component: as_rigid_as_possible}", kLibrary);
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
