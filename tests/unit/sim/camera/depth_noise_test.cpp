#include "sim/camera/depth_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {
namespace {

constexpr int kWidth = 200, kHeight = 160;

draw::Intrinsics intrinsics() { return {585, 585, 99.5, 79.5}; }

DepthNoiseOptions only_noise() {
  DepthNoiseOptions options;
  options.disparity_step = 0;
  options.edge_loss = 0;
  return options;
}

/// A plane through the optical axis at `distance`, rotated about the image's vertical by `angle`.
draw::DepthImage plane(double distance, double angle) {
  draw::DepthImage image{kWidth, kHeight, std::vector<float>(std::size_t(kWidth) * kHeight)};
  const draw::Intrinsics k = intrinsics();
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column)
      image.metres[std::size_t(row) * kWidth + column] =
          static_cast<float>(distance / (1 - std::tan(angle) * (column - k.cx) / k.fx));
  return image;
}

struct Statistics {
  double mean = 0;
  double deviation = 0;
  int count = 0;
  int empty = 0;
};

/// Errors at the centre of the image, where distance and angle are the requested ones.
Statistics errors(const draw::DepthImage& measured, const draw::DepthImage& truth, int half_width) {
  Statistics s;
  double squares = 0;
  for (int row = 20; row < kHeight - 20; ++row) {
    for (int column = kWidth / 2 - half_width; column < kWidth / 2 + half_width; ++column) {
      if (measured.at(column, row) == 0) {
        ++s.empty;
        continue;
      }
      const double e = measured.at(column, row) - truth.at(column, row);
      s.mean += e;
      squares += e * e;
      ++s.count;
    }
  }
  s.mean /= s.count;
  s.deviation = std::sqrt(squares / s.count - s.mean * s.mean);
  return s;
}

TEST(DepthNoise, GrowsWithDistanceAndAngleAsPublished) {
  const DepthNoise noise(only_noise(), intrinsics());
  for (const double distance : {0.6, 0.8, 1.5, 3.0}) {
    for (const double angle : {0.0, 0.5, 1.2}) {
      const draw::DepthImage truth = plane(distance, angle);
      const Statistics s = errors(noise.apply(truth, math::Random(4)), truth, 10);
      // Nguyen et al. 2012, eq. 3, with the numbers of the paper.
      double expected = 0.0012 + 0.0019 * std::pow(distance - 0.4, 2);
      if (angle > M_PI / 3)
        expected += 0.0001 / std::sqrt(distance) * std::pow(angle / (M_PI / 2 - angle), 2);
      EXPECT_EQ(s.empty, 0);
      EXPECT_NEAR(s.mean, 0, 4 * expected / std::sqrt(s.count)) << distance << " " << angle;
      EXPECT_NEAR(s.deviation, expected, 0.05 * expected) << distance << " " << angle;
    }
  }
}

TEST(DepthNoise, DisparityComesInSteps) {
  DepthNoiseOptions options = only_noise();
  options.scale = 0;
  options.disparity_step = 0.125;
  const DepthNoise noise(options, intrinsics());
  const draw::DepthImage truth = plane(1, 0.6);
  const draw::DepthImage measured = noise.apply(truth, math::Random(1));
  double worst = 0;
  for (std::size_t i = 0; i < truth.metres.size(); ++i) {
    const double counts = 8 * 0.075 * 585 / measured.metres[i];
    ASSERT_NEAR(counts, std::round(counts), 1e-3);
    worst = std::max(worst, std::abs(double(measured.metres[i]) - truth.metres[i]));
  }
  // Half a step: 2.85e-3 z^2 / 2 (Khoshelham and Elberink 2012, where it is given for cm), z
  // to 1.14.
  const double z = *std::max_element(truth.metres.begin(), truth.metres.end());
  EXPECT_NEAR(worst, 0.5 * 2.85e-3 * z * z, 0.1 * worst);
}

TEST(DepthNoise, DeviationIsWhatAFrontalSurfaceShows) {
  DepthNoiseOptions options;
  const DepthNoise noise(options, intrinsics());
  for (const double distance : {0.8, 2.0}) {
    // A slight slope, so that the steps occur at every position.
    const draw::DepthImage truth = plane(distance, 0.2);
    const Statistics s = errors(noise.apply(truth, math::Random(2)), truth, 60);
    EXPECT_NEAR(s.deviation, noise.deviation(distance), 0.05 * s.deviation) << distance;
  }
}

TEST(DepthNoise, GrazingSurfacesAndWhatIsOutOfRangeAreNotSeen) {
  const DepthNoise noise(DepthNoiseOptions(), intrinsics());
  const auto share = [&](double distance, double angle) {
    const draw::DepthImage truth = plane(distance, angle);
    const Statistics s = errors(noise.apply(truth, math::Random(1)), truth, 5);
    return s.count / double(s.count + s.empty);
  };
  EXPECT_EQ(share(1, 1.3), 1);
  EXPECT_EQ(share(1, 1.45), 0);
  EXPECT_EQ(share(0.4, 0), 0);
  EXPECT_EQ(share(5.5, 0), 0);
}

/// A square of 60 px at 0.8 m before a wall at 1.2 m.
draw::DepthImage step_picture() {
  draw::DepthImage image = plane(1.2, 0);
  for (int row = 50; row < 110; ++row)
    for (int column = 70; column < 130; ++column)
      image.metres[std::size_t(row) * kWidth + column] = 0.8F;
  return image;
}

TEST(DepthNoise, EdgesLoseTheirShareOfPixels) {
  DepthNoiseOptions options = only_noise();
  options.scale = 0;
  options.edge_loss = 0.4;
  const DepthNoise noise(options, intrinsics());
  int lost = 0;
  const int pictures = 20;
  for (int i = 0; i < pictures; ++i) {
    const draw::DepthImage measured = noise.apply(step_picture(), math::Random(i));
    for (std::size_t p = 0; p < measured.metres.size(); ++p) lost += measured.metres[p] == 0;
  }
  const int near_edge = 4 * 60 + 4 * 60 - 4;  // outside and inside of the outline
  const double n = pictures * near_edge;
  EXPECT_NEAR(lost / n, 0.4, 4 * std::sqrt(0.24 / n));
}

TEST(DepthNoise, EdgesAreSeenNextToWhereTheyAre) {
  DepthNoiseOptions options = only_noise();
  const DepthNoise noise(options, intrinsics());
  // The fraction of near pixels in the columns around the left edge is the tail of lateral noise.
  const int pictures = 40;
  std::vector<double> near(kWidth);
  for (int i = 0; i < pictures; ++i) {
    const draw::DepthImage measured = noise.apply(step_picture(), math::Random(i));
    for (int column = 60; column < 80; ++column)
      for (int row = 60; row < 100; ++row) near[column] += measured.at(column, row) < 1;
  }
  const double n = pictures * 40;
  const double sigma = lateral_noise(0);
  for (int column = 66; column < 74; ++column) {
    const double outside = 69.5 - column;  // px to the edge, half a pixel before column 70
    const double expected = 0.5 * std::erfc(outside / (sigma * std::sqrt(2.0)));
    EXPECT_NEAR(near[column] / n, expected, 4 * std::sqrt(0.25 / n)) << column;
  }
}

TEST(DepthNoise, SeedDecidesAlone) {
  const DepthNoise noise(DepthNoiseOptions(), intrinsics());
  const draw::DepthImage truth = step_picture();
  const draw::DepthImage a = noise.apply(truth, math::Random(7, "camera"));
  EXPECT_EQ(a.metres, noise.apply(truth, math::Random(7, "camera")).metres);
  EXPECT_NE(a.metres, noise.apply(truth, math::Random(8, "camera")).metres);
}

TEST(DepthNoise, WithoutFaultsIsTheTruth) {
  DepthNoiseOptions options = only_noise();
  options.scale = 0;
  const draw::DepthImage truth = step_picture();
  EXPECT_EQ(DepthNoise(options, intrinsics()).apply(truth, math::Random(1)).metres, truth.metres);
}

TEST(DepthNoise, RefusesNonsense) {
  for (const auto spoil :
       {+[](DepthNoiseOptions& o) { o.scale = -1; }, +[](DepthNoiseOptions& o) { o.base = 0; },
        +[](DepthNoiseOptions& o) { o.disparity_step = -1; },
        +[](DepthNoiseOptions& o) { o.edge_loss = 1.1; },
        +[](DepthNoiseOptions& o) { o.most_angle = 1.6; },
        +[](DepthNoiseOptions& o) { o.farthest = o.nearest; }}) {
    DepthNoiseOptions options;
    spoil(options);
    EXPECT_THROW(DepthNoise(options, intrinsics()), std::invalid_argument);
  }
}

}  // namespace
}  // namespace palpate::camera
