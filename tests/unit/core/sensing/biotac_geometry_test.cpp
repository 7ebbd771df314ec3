#include "core/sensing/biotac_geometry.hpp"

#include <gtest/gtest.h>

namespace palpate::sensing {
namespace {

TEST(NearestArea, IsItsOwnAtEachCentreAndMirrorsAcrossTheMiddle) {
  const int mirrored[] = {1, 2, 3, 5, 4, 7, 6, 9, 8};
  for (int area = 1; area <= kAreaCount; ++area) {
    const Eigen::Vector3d centre = area_centres().col(area - 1);
    EXPECT_EQ(nearest_area(centre), area);
    EXPECT_EQ(nearest_area(project_on_skin(centre)), area);
    EXPECT_EQ(nearest_area({centre.x(), -centre.y(), centre.z()}), mirrored[area - 1]);
  }
  EXPECT_EQ(nearest_area({-15e-3, 0, -7e-3}), 1);
  EXPECT_EQ(nearest_area({6e-3, 0, -3e-3}), 3);
}

}  // namespace
}  // namespace palpate::sensing
