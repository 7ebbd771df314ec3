#include <gtest/gtest.h>

#include <sstream>

#include "tools/common/vtu_writer.hpp"

namespace palpate::common {
namespace {

TEST(WriteVtu, AFieldOfAnotherLengthIsRefused) {
  Grid grid;
  grid.points = Eigen::Matrix3Xd::Zero(3, 2);
  grid.cells = Eigen::RowVector2i(0, 1);
  grid.point_fields = {{"wrong", Eigen::MatrixXd::Zero(1, 3)}};
  std::ostringstream out;
  EXPECT_THROW(write_vtu(grid, VtuEncoding::kBase64, out), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::common
