#include "tools/view/shape_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/tools/view/shapes.hpp"

namespace palpate::view {
namespace {

class ShapeErrorTest : public ::testing::Test {
 protected:
  /// All nodes moved along x by `x` m at `utime`.
  shape_t moved(double x, std::int64_t utime) const {
    shape_t shape = shape_of(*mesh_, [x](const Eigen::Vector3f& p) -> Eigen::Vector3f {
      return p + Eigen::Vector3f(static_cast<float>(x), 0, 0);
    });
    shape.utime = utime;
    return shape;
  }
  void take(const shape_t& shape, const shape_t& truth) {
    error_.take(*mesh_, shape, *mesh_, truth);
  }

  std::shared_ptr<const shape_mesh_t> mesh_ = box_mesh({3, 2, 1});
  ShapeError error_;
};

TEST_F(ShapeErrorTest, IsTheDistanceOfEachNodeFromItsMaterial) {
  shape_t truth = moved(0.01, 1'000);
  ASSERT_EQ(truth.node_count % 2, 0);
  for (int i = 0; i < truth.node_count; ++i)
    truth.xyz[static_cast<std::size_t>(3 * i + 1)] += i % 2 == 0 ? 1e-3F : 3e-3F;
  const shape_t shape = moved(0.01, 5'000);
  take(shape, truth);
  EXPECT_FALSE(error_.last()) << "one truth";
  truth.utime = 10'000;
  take(shape, truth);
  ASSERT_TRUE(error_.last());
  EXPECT_NEAR(error_.last()->mean, 2e-3, 1e-7);
  EXPECT_NEAR(error_.last()->rms, std::sqrt(5.0) * 1e-3, 1e-7);
  EXPECT_NEAR(error_.last()->largest, 3e-3, 1e-7);
  EXPECT_FALSE(error_.last()->by_arrival);
}

TEST_F(ShapeErrorTest, InterpolatesTheTruthAtTheShapesTime) {
  take(moved(0.0125, 12'500), moved(0, 0));
  take(moved(0.0125, 12'500), moved(0.010, 10'000));
  EXPECT_FALSE(error_.last()) << "the shape is newer";
  take(moved(0.018, 18'000), moved(0.020, 20'000));
  ASSERT_TRUE(error_.last());
  EXPECT_NEAR(error_.last()->largest, 0, 1e-7);
  take(moved(0.031, 29'000), moved(0.030, 30'000));
  EXPECT_NEAR(error_.last()->largest, 2e-3, 1e-7);
}

TEST_F(ShapeErrorTest, ComparesAsTheyArriveWhereClocksDiffer) {
  take(moved(0.004, 50'000'000), moved(0, 0));
  take(moved(0.004, 50'000'000), moved(0.001, 10'000));
  ASSERT_TRUE(error_.last());
  EXPECT_TRUE(error_.last()->by_arrival);
  EXPECT_NEAR(error_.last()->mean, 3e-3, 1e-7);
}

TEST_F(ShapeErrorTest, BeginsAgainAfterAJump) {
  take(moved(0, 5'000), moved(0.001, 0));
  take(moved(0, 5'000), moved(0.001, 10'000));
  ASSERT_TRUE(error_.last());
  take(moved(0, 2'000), moved(0.001, 2'000));
  EXPECT_FALSE(error_.last()) << "back in a log";
}

TEST_F(ShapeErrorTest, IsUnknownForAMeshWithoutElements) {
  shape_mesh_t empty = *mesh_;
  empty.elements.clear();
  for (const std::int64_t utime : {0, 10'000})
    error_.take(*mesh_, moved(0, 5'000), empty, moved(0, utime));
  EXPECT_FALSE(error_.last());
}

}  // namespace
}  // namespace palpate::view
