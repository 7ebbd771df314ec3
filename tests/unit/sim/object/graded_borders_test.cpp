#include "sim/object/graded_borders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace palpate::object {
namespace {

std::vector<double> lengths(const std::vector<double>& borders) {
  std::vector<double> steps(borders.size());
  std::adjacent_difference(borders.begin(), borders.end(), steps.begin());
  steps.erase(steps.begin());
  return steps;
}

TEST(GradedBorders, EqualWithoutGrowthOrPlanes) {
  for (const auto& borders :
       {graded_borders(0.5, 7, {0, 0.45}, 1), graded_borders(0.5, 7, {}, 1.5)}) {
    ASSERT_EQ(borders.size(), 8u);
    for (int i = 0; i < 8; ++i) EXPECT_NEAR(borders[i], i * 0.5 / 7, 1e-9);
    EXPECT_EQ(borders.front(), 0);
    EXPECT_EQ(borders.back(), 0.5);
  }
}

TEST(GradedBorders, PlanesAreCutsAndLengthsGrowAwayFromThem) {
  constexpr double kGrowth = 1.3;
  const std::vector<double> borders = graded_borders(0.5, 14, {0.45, 0}, kGrowth);
  ASSERT_EQ(borders.size(), 15u);
  const auto plane = std::find(borders.begin(), borders.end(), 0.45);
  ASSERT_NE(plane, borders.end());
  const std::vector<double> sides = lengths(borders);
  const auto grasp = sides.begin() + (plane - borders.begin());
  for (auto side = sides.begin(); side < grasp; ++side)
    EXPECT_NEAR(*side, *(grasp - 1 - (side - sides.begin())), 1e-9);  // symmetric
  for (auto side = sides.begin(); side + 1 < grasp - (grasp - sides.begin() + 1) / 2; ++side)
    EXPECT_NEAR(*(side + 1) / *side, kGrowth, 0.05);
  for (auto side = grasp; side + 1 < sides.end(); ++side)
    EXPECT_NEAR(*(side + 1) / *side, kGrowth, 0.2);
}

TEST(GradedBorders, OnePlaneAtTheUpperEnd) {
  const std::vector<double> sides = lengths(graded_borders(1, 6, {1}, 1.5));
  EXPECT_NEAR(std::accumulate(sides.begin(), sides.end(), 0.0), 1, 1e-15);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) EXPECT_GT(sides[i], 1.3 * sides[i + 1]);
}

TEST(GradedBorders, RefusesWhatCannotBe) {
  EXPECT_THROW(graded_borders(0, 2, {}, 1), std::invalid_argument);
  EXPECT_THROW(graded_borders(1, 0, {}, 1), std::invalid_argument);
  EXPECT_THROW(graded_borders(1, 2, {}, 0.9), std::invalid_argument);
  EXPECT_THROW(graded_borders(1, 2, {0.2, 0.6}, 1.2), std::invalid_argument);
  EXPECT_NO_THROW(graded_borders(1, 2, {0.2, 0.6}, 1));
}

TEST(GradedBorders, HoldsBeginAtTheirFacesWithinTheBodyAndAtFlatOnes) {
  const Eigen::Vector3d origin(1, 2, 3), size(0.5, 0.06, 0.06);
  const Box clamp{origin, origin + Eigen::Vector3d(0, 0.06, 0.06)};
  const Box grasp{origin + Eigen::Vector3d(0.45, 0, 0.02), origin + size};
  EXPECT_EQ(planes_of(clamp, origin, size, 0), std::vector<double>{0});
  EXPECT_TRUE(planes_of(clamp, origin, size, 1).empty());
  ASSERT_EQ(planes_of(grasp, origin, size, 0).size(), 1u);
  EXPECT_NEAR(planes_of(grasp, origin, size, 0)[0], 0.45, 1e-12);
  EXPECT_TRUE(planes_of(grasp, origin, size, 1).empty());
  ASSERT_EQ(planes_of(grasp, origin, size, 2).size(), 1u);
}

TEST(GradedBorders, ReportsHoldsThatEndBetweenNodes) {
  const Eigen::Vector3d origin(1, 0, 0), size(0.5, 0.06, 0.06);
  const Box clamp{origin, origin + Eigen::Vector3d(0.02, 0.06, 0.06)};
  const auto borders = [&](double grading) {
    std::array<std::vector<double>, 3> all;
    for (int axis = 0; axis < 3; ++axis) {
      all[axis] = graded_borders(size[axis], axis == 0 ? 10 : 2,
                                 planes_of(clamp, origin, size, axis), grading);
    }
    return all;
  };
  EXPECT_TRUE(misfits(clamp, origin, borders(1.3), false).empty());  // a plane of its own
  for (const bool midnodes : {false, true}) {
    const std::vector<std::string> found = misfits(clamp, origin, borders(1), midnodes);
    ASSERT_EQ(found.size(), 1u) << midnodes;
    EXPECT_NE(found[0].find("1.02"), std::string::npos) << found[0];
    if (!midnodes) {
      EXPECT_NE(found[0].find("1 m instead"), std::string::npos) << found[0];
    }
  }
  // Elements of 50 mm have nodes every 25 mm; only a clamp of single nodes may end halfway.
  const Box halfway{origin, origin + Eigen::Vector3d(0.025, 0.06, 0.06)};
  EXPECT_EQ(misfits(halfway, origin, borders(1), false).size(), 1u);
  EXPECT_TRUE(misfits(halfway, origin, borders(1), true).empty());
}

}  // namespace
}  // namespace palpate::object
