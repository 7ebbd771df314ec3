#include "tools/fit/experiments/skin.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/fit/gradient.hpp"

namespace palpate::fit {
namespace {

class Skin : public ::testing::Test {
 protected:
  Skin() { write(-1); }

  /// Four points between pads 30 mm apart, one of which moves 1 mm per frame.
  void write(double force_sign) {
    std::ofstream field(folder_.path() / "field.csv"), pads(folder_.path() / "pads.csv");
    field << "frame,point,x,y\n";
    pads << "frame,mx,my,fx,fy,force\n";
    for (int f = 0; f < 4; ++f) {
      for (int p = 0; p < 4; ++p) {
        field << f << "," << p << "," << 8 + 2 * p - 0.4 * f << "," << 3 * (p % 2) << "\n";
      }
      pads << f << "," << -f << ",0,30,0," << force_sign * 0.02 * f << "\n";
    }
  }

  config::Node node(const std::string& frames = "{fitted: [1, 2], predicted: [3]}") {
    return config::Node::from_text(R"(
name: skin
file: field.csv
columns:
  frame: {name: frame, unit: ""}
  point: {name: point, unit: ""}
  x: {name: x, unit: mm}
  y: {name: y, unit: mm}
pads:
  file: pads.csv
  columns:
    frame: {name: frame, unit: ""}
    moving_x: {name: mx, unit: mm}
    moving_y: {name: my, unit: mm}
    fixed_x: {name: fx, unit: mm}
    fixed_y: {name: fy, unit: mm}
    force: {name: force, unit: N}
geometry: {pad_width: 20 mm, pad_length: 10 mm, margin: 20 mm, cell: 10 mm}
frames: )" + frames);
  }
  support::ScratchFolder folder_;
};

TEST_F(Skin, DerivativesMatchDifferences) {
  const auto skin = make_membrane(node(), folder_.path());
  Eigen::VectorXd at(6);
  at << 2, 8, 3, 0.3, 1e4, 2e-3;
  const Eigen::VectorXd errors = gradient_errors(*skin, at, 1e-3 * at);
  for (int p = 0; p < 6; ++p) EXPECT_LT(errors[p], 1e-6) << skin->parameters()[p].name;
}

/// The force on the pad increases with the stiffness of the sheet and its foundation; points follow
/// it.
TEST_F(Skin, PointsFollowThePad) {
  const auto skin = make_membrane(node(), folder_.path());
  Eigen::VectorXd at(6), soft, stiff;
  at << 2, 8, 3, 0, 1e4, 2e-3;
  ASSERT_TRUE(skin->predict(at, soft, nullptr));
  const Eigen::Index force = skin->series()[0].x.size();
  for (int p = 0; p < 4; ++p) {
    EXPECT_LT(soft[2 * p], 0);
    EXPECT_GT(soft[2 * p], -1e-3);
    EXPECT_LT(soft[8 + 2 * p], soft[2 * p]);
  }
  at[4] *= 4;
  ASSERT_TRUE(skin->predict(at, stiff, nullptr));
  EXPECT_LT(stiff[force], soft[force]);
  EXPECT_LT(soft[force], 0);
  EXPECT_GT(stiff[6], soft[6]);
}

TEST_F(Skin, SaysWhatIsWrongWithIt) {
  EXPECT_THROW(make_membrane(node("{fitted: [0], predicted: [3]}"), folder_.path()), config::Error);
  EXPECT_ANY_THROW(make_membrane(node("{fitted: [1, 9], predicted: [3]}"), folder_.path()));
  write(1);
  EXPECT_ANY_THROW(make_membrane(node(), folder_.path()));
}

}  // namespace
}  // namespace palpate::fit
