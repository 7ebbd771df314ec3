#include "core/estimation/shape_jump.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::estimation {
namespace {

constexpr double kStep = 1e-3;  // s

/// Half a metre long: 5 mm and 2 mm in a step are no jump.
Eigen::Matrix3Xd shape_jump_bar() {
  Eigen::Matrix3Xd nodes(3, 3);
  nodes << 0, 0.25, 0.5, 0, 0.06, 0, 0, 0, 0.06;
  return nodes;
}

TEST(ShapeJump, OneNodeTooFarIsAJumpAndSoIsItsWayBack) {
  ShapeJump jump(shape_jump_bar());
  Eigen::Matrix3Xd x = shape_jump_bar();
  EXPECT_FALSE(jump.update(x, kStep));
  x(2, 1) += 6.9e-3;
  EXPECT_FALSE(jump.update(x, kStep));
  x(1, 2) -= 7.1e-3;
  EXPECT_TRUE(jump.update(x, kStep));
  EXPECT_FALSE(jump.update(x, kStep)) << "it stays there";
  x(1, 2) += 7.1e-3;
  EXPECT_TRUE(jump.update(x, kStep));
}

TEST(ShapeJump, SlowLoopsMayMoveFurtherInACycle) {
  ShapeJump jump(shape_jump_bar());
  Eigen::Matrix3Xd x = shape_jump_bar();
  jump.update(x, 1e-2);
  x.row(0).array() += 0.024;
  EXPECT_FALSE(jump.update(x, 1e-2));
  x.row(0).array() += 0.026;
  EXPECT_TRUE(jump.update(x, 1e-2));
}

TEST(ShapeJump, AForgottenJumpIsNotReported) {
  ShapeJump jump(shape_jump_bar());
  Eigen::Matrix3Xd x = shape_jump_bar().array() + 1;
  EXPECT_FALSE(jump.update(x, kStep)) << "the first";
  jump.forget();
  EXPECT_FALSE(jump.update(shape_jump_bar(), kStep));
}

TEST(ShapeJump, NotFiniteIsAJump) {
  for (const double odd :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ShapeJump jump(shape_jump_bar());
    Eigen::Matrix3Xd x = shape_jump_bar();
    jump.update(x, kStep);
    x(0, 0) = odd;
    EXPECT_TRUE(jump.update(x, kStep));
  }
}

}  // namespace
}  // namespace palpate::estimation
