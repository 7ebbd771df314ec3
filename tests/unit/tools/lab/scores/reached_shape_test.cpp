#include "tools/lab/scores/reached_shape.hpp"

#include <gtest/gtest.h>

#include "core/math/rigid.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"

namespace palpate::scores {
namespace {

/// Clamped points stay, held points follow the hand except for the pads' compliance, and those in
/// between do neither.
TEST(ReachedShape, IsThatOfABarBetweenClampAndHand) {
  const studies::StudyFolder folder;
  const auto scene = folder.write(
      "scene.yaml", std::string("base: ") + PALPATE_SOURCE_DIR +
                        "/sim/scenes/bar_long_soft_control.yaml\n"
                        "object: {elements: [7, 1, 1], pads: {stiffness: 1e4}, "
                        "grasp_box: {lower: [0.428, 0, 0], upper: [0.5, 0.06, 0.06]}}\n");
  runs::ControlTarget target;
  target.kind = "points";
  target.rest_points = {{0, 0, 0.06}, {0.25, 0.03, 0.06}, {0.48, 0.03, 0.06}};
  const runs::HandMotion motion{{-0.01, 0.03, 0.05}, {15, -10, 5}};
  const Eigen::Matrix3Xd reached = reached_value(scene, target, motion).reshaped(3, 3);
  EXPECT_LT((reached.col(0) - target.rest_points[0]).norm(), 1e-9);
  const Eigen::Vector3d p_OG(0.47, 0.03, 0.03);  // as in the scene
  const Eigen::Vector3d held =
      p_OG + motion.translation +
      math::exp_rotation(M_PI / 180 * motion.rotation_deg) * (target.rest_points[2] - p_OG);
  EXPECT_LT((reached.col(2) - held).norm(), 1e-3);
  const Eigen::Vector3d moved = reached.col(1) - target.rest_points[1];
  EXPECT_GT(moved.z(), 0.005);
  EXPECT_LT(moved.z(), 0.04);
  EXPECT_GT(moved.y(), 0.005);
}

}  // namespace
}  // namespace palpate::scores
