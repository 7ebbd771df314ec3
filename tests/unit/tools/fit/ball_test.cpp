#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/fit/gradient.hpp"
#include "tools/fit/experiments/ball.hpp"

namespace palpate::fit {
namespace {

TEST(Spline, GoesThroughItsPointsSmoothly) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, 0, 2);
  const Spline spline(x, x.array().sin());
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(spline.value(x[i]), std::sin(x[i]), 1e-14);
  EXPECT_NEAR(spline.value(0.6), std::sin(0.6), 1e-3);
  for (double at : {-0.5, 0.6, 1.999, 2.5}) {
    EXPECT_NEAR((spline.value(at + 1e-6) - spline.value(at - 1e-6)) / 2e-6, spline.slope(at), 1e-8);
  }
}

class Ball : public ::testing::Test {
 protected:
  Ball() {
    std::ofstream file(folder_.path() / "press.csv");
    file << "d,f\n";
    for (int i = 0; i < 10; ++i) file << 0.3 * i << "," << 0.2 * i * i << "\n";
  }
  config::Node node(const std::string& more) {
    return config::Node::from_text(
        "name: press\nfile: press.csv\ncolumns: {depth: {name: d, unit: mm}, force: {name: f, "
        "unit: "
        "N}}\n" +
        more);
  }
  support::ScratchFolder folder_;
};

/// A thick layer behaves like a half space at small depth, and a thin one is stiffer.
TEST_F(Ball, IsHertzWhereHertzHolds) {
  const std::string radius = "geometry: {radius: 50 mm, thickness: ";
  const auto thick = make_indentation(node(radius + "0.5 m}\n"), folder_.path());
  const auto thin = make_indentation(node(radius + "60 mm}\n"), folder_.path());
  const auto hertz =
      make_hertz(node("poisson_ratio: 0.49\ngeometry: {radius: 50 mm}\n"), folder_.path());
  Eigen::VectorXd by_thick, by_thin, by_hertz;
  ASSERT_TRUE(thick->predict(Eigen::Vector3d(1e5, 0.49, 0), by_thick, nullptr));
  ASSERT_TRUE(thin->predict(Eigen::Vector3d(1e5, 0.49, 0), by_thin, nullptr));
  ASSERT_TRUE(hertz->predict(Eigen::Vector3d(1e5, 0.49, 0), by_hertz, nullptr));
  EXPECT_NEAR(by_thick[9] / by_hertz[9], 1, 0.04);
  EXPECT_GT(by_thin[9] / by_hertz[9], 1.1);
}

TEST_F(Ball, DerivativesMatchDifferences) {
  const auto ball =
      make_indentation(node("geometry: {radius: 50 mm, thickness: 60 mm}\n"), folder_.path());
  Eigen::VectorXd value, ahead, behind;
  for (double offset : {-2.3e-4, 3.7e-4}) {
    Eigen::MatrixXd jacobian;
    ASSERT_TRUE(ball->predict(Eigen::Vector3d(8e4, 0.49, offset), value, &jacobian));
    const auto check = [&](int column, const Eigen::Vector3d& step) {
      const Eigen::Vector3d x(8e4, 0.49, offset);
      ASSERT_TRUE(ball->predict(x + step, ahead, nullptr));
      ASSERT_TRUE(ball->predict(x - step, behind, nullptr));
      const Eigen::VectorXd slope = (ahead - behind) / (2 * step[column]);
      EXPECT_LT((jacobian.col(column) - slope).norm(), 1e-6 * slope.norm());
    };
    check(0, {10, 0, 0});
    check(2, {0, 0, 1e-8});
  }
}

TEST_F(Ball, SaysWhatIsWrongWithIt) {
  const auto make = [&](const std::string& more) {
    return make_indentation(node(more), folder_.path());
  };
  EXPECT_THROW(make("geometry: {radius: 3 mm}\n"), config::Error);
  EXPECT_THROW(make("geometry: {radius: 3 mm, thickness: 0.1 mm}\n"), config::Error);
  EXPECT_THROW(make("poisson_ratio: 0.5\ngeometry: {radius: 3 mm, thickness: 9 mm}\n"),
               config::Error);
}

}  // namespace
}  // namespace palpate::fit
