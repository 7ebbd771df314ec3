#include "rt/pipeline/shape_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/math/constants.hpp"
#include "rt/config/node.hpp"
#include "rt/loop/allocation_counter.hpp"

namespace palpate::pipeline {
namespace {

TEST(ShapeWatch, AnObjectThatTouchesItselfIsReportedWhileItDoes) {
  const auto root = config::Node::load_file(std::string(PALPATE_SOURCE_DIR) +
                                            "/rt/config/examples/bar_long_soft.yaml");
  const registry::Object object = registry::read_object(root, registry::read_frames(root));
  ShapeWatch watch(object);
  const Eigen::Matrix3Xd& rest = object.body.mesh.nodes;
  const auto condition_after = [&](const Eigen::Matrix3Xd& x) {
    const auto allocations = loop::allocations_of_this_thread();
    for (int i = 0; i < 1000; ++i) watch.update(x, 1e-3);
    EXPECT_EQ(loop::allocations_of_this_thread(), allocations);
    return watch.condition();
  };
  EXPECT_EQ(condition_after(rest).state, LifeCycle::kActive);

  // A bar of 0.5 m, bent about y until its ends are in one place.
  Eigen::Matrix3Xd ring = rest;
  const double radius = 0.5 / (2.3 * math::kPi);
  for (Eigen::Index i = 0; i < ring.cols(); ++i) {
    const double at = rest(0, i) / radius, r = radius - 0.5 * (rest(2, i) - 0.03);
    ring.col(i) = Eigen::Vector3d(r * std::sin(at), rest(1, i), radius - r * std::cos(at));
  }
  const Condition touching = condition_after(ring);
  EXPECT_EQ(touching.state, LifeCycle::kDegraded);
  EXPECT_NE(std::string(touching.reason).find("touches itself"), std::string::npos);
  EXPECT_EQ(condition_after(rest).state, LifeCycle::kActive);
  condition_after(ring);
  watch.forget();
  EXPECT_EQ(watch.condition().state, LifeCycle::kActive);
}

}  // namespace
}  // namespace palpate::pipeline
