#include "core/sensing/input_domain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::sensing {
namespace {

InputDomain two_points() {
  InputDomain domain;
  domain.points.resize(2, 2);
  domain.points << 0, 10, 0, 0;
  domain.deviation = Eigen::Vector2d(1, 0.5);
  domain.near = 1;
  domain.far = 3;
  return domain;
}

TEST(InputDomain, FadesWithTheDistanceToTheNearestPoint) {
  const InputDomain domain = two_points();
  EXPECT_EQ(domain.trust(Eigen::Vector2d(0.9, 0)), 1);
  EXPECT_EQ(domain.trust(Eigen::Vector2d(9.2, 0)), 1);
  EXPECT_NEAR(domain.trust(Eigen::Vector2d(2, 0)), 0.5, 1e-12);
  EXPECT_NEAR(domain.trust(Eigen::Vector2d(0, 1)), 0.5,
              1e-12);  // two standard deviations of the second
  EXPECT_EQ(domain.trust(Eigen::Vector2d(3, 0)), 0);
  EXPECT_EQ(domain.trust(Eigen::Vector2d(-1e9, 0)), 0);
  EXPECT_EQ(domain.trust(Eigen::Vector2d(std::nan(""), 0)), 0);
  EXPECT_EQ(InputDomain().trust(Eigen::Vector2d(5, 5)), 1);
}

TEST(InputDomain, HasNoKink) {
  const InputDomain domain = two_points();
  const auto slope = [&](double x) {
    return (domain.trust(Eigen::Vector2d(x + 1e-6, 0)) - domain.trust(Eigen::Vector2d(x, 0))) /
           1e-6;
  };
  EXPECT_NEAR(slope(-1.0), 0, 1e-5);
  EXPECT_NEAR(slope(-3.0), 0, 1e-5);
  EXPECT_NEAR(slope(-2.0), 0.75, 1e-5);  // 3/2 over far - near
}

TEST(InputDomain, CoversAllRows) {
  Eigen::MatrixXd rows(400, 2);
  for (int k = 0; k < 400; ++k) rows.row(k) << std::cos(0.02 * k), 5 * std::sin(0.03 * k);
  const Eigen::Vector2d deviation(1, 5);
  const InputDomain coarse = cover(rows, deviation, 5, 1, 2);
  const InputDomain fine = cover(rows, deviation, 40, 1, 2);
  EXPECT_LT(fine.near, 0.5 * coarse.near);
  for (int k = 0; k < 400; ++k) EXPECT_EQ(coarse.trust(rows.row(k).transpose()), 1);
  EXPECT_EQ(coarse.far, 2 * coarse.near);
  EXPECT_EQ(cover(rows.topRows(3), deviation, 40, 1, 2).points.cols(), 3);
  EXPECT_THROW(cover(rows.topRows(0), deviation, 40, 1, 2), std::invalid_argument);
}

TEST(InputDomain, RefusesWhatDoesNotFit) {
  two_points().check(2);
  EXPECT_THROW(two_points().check(3), std::invalid_argument);
  InputDomain domain = two_points();
  domain.far = domain.near;
  EXPECT_THROW(domain.check(2), std::invalid_argument);
  domain = two_points();
  domain.deviation[0] = 0;
  EXPECT_THROW(domain.check(2), std::invalid_argument);
  domain = two_points();
  domain.points(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(domain.check(2), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing
