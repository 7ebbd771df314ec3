#include "sim/draw/renderer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace palpate::draw {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr Colour kRed{0.9F, 0.1F, 0.1F, 1};
constexpr Colour kBlue{0.1F, 0.1F, 0.9F, 1};

View view_along_x(double distance) {
  return make_view({-distance, 0, 0}, {0, 0, 0}, {0, 0, 1}, 0.8, kWidth, kHeight);
}

bool reddish(const std::uint8_t* pixel) { return pixel[0] > 1.5 * pixel[2]; }

struct Coverage {
  int count = 0;
  double column = 0;  // mean
  double row = 0;
};

Coverage covered(const DepthImage& depth) {
  Coverage c;
  for (int row = 0; row < depth.height; ++row) {
    for (int column = 0; column < depth.width; ++column) {
      if (depth.at(column, row) == 0) continue;
      ++c.count;
      c.column += column;
      c.row += row;
    }
  }
  c.column /= c.count;
  c.row /= c.count;
  return c;
}

TEST(OsMesa, SaysWhatIsMissing) {
  try {
    OsMesa missing("libNoSuchMesa.so.8");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("libNoSuchMesa.so.8"), std::string::npos);
  }
}

TEST(Renderer, CubeCoversThePixelsThatThePinholeModelSays) {
  for (const int supersampling : {1, 2}) {
    Renderer renderer(kWidth, kHeight, supersampling);
    View view = view_along_x(2);
    view.intrinsics.cx = 140.25;  // an off-centre optical axis
    view.intrinsics.cy = 131;
    renderer.begin(view);
    math::Pose X = math::Pose::Identity();
    X.translation() << 0, 0.21, 0.13;  // camera right is -y, down is -z
    const double side = 0.3;
    renderer.draw_box(X, {side, side, side}, kRed);
    renderer.end();
    // Only the near face is visible, except for slivers of the sides seen from inside the view
    // frustum.
    const double z = 2 - side / 2;
    const double focal = view.intrinsics.fx;
    const double far_z = 2 + side / 2;
    const auto column = [&](double y, double depth) { return -focal * y / depth + 140.25; };
    const auto row = [&](double up, double depth) { return -focal * up / depth + 131; };
    const double left = column(0.21 + side / 2, z);
    const double right = std::max(column(0.21 - side / 2, z), column(0.21 - side / 2, far_z));
    const double top = row(0.13 + side / 2, z);
    const double bottom = std::max(row(0.13 - side / 2, z), row(0.13 - side / 2, far_z));
    const Coverage seen = covered(renderer.depth());
    const double area = (right - left) * (bottom - top);
    EXPECT_NEAR(seen.count, area, 1.5 * (right - left + bottom - top));
    EXPECT_NEAR(seen.column, 0.5 * (left + right), 0.6);
    EXPECT_NEAR(seen.row, 0.5 * (top + bottom), 0.6);
    EXPECT_NEAR(renderer.depth().at(std::lround(seen.column), std::lround(seen.row)), z, 1e-4);
  }
}

TEST(Renderer, DepthOfASlantedPlaneIsMetric) {
  Renderer renderer(kWidth, kHeight);
  const View view = view_along_x(1.2);
  Eigen::Matrix3Xd corners(3, 4);
  corners << -0.3, -0.3, 0.5, 0.5,  //
      -2, 2, 2, -2,                 //
      -1, -1, 1, 1;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  renderer.begin(view);
  MeshStyle style;
  style.edges = kBlue;  // edges must not disturb the depth
  renderer.draw_mesh(corners, triangles, style);
  renderer.end();
  const Eigen::Vector3d normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(3) - corners.col(0)).normalized();
  const double offset = normal.dot(corners.col(0));
  double worst = 0;
  int seen = 0;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double depth = renderer.depth().at(column, row);
      if (depth == 0) continue;
      const Intrinsics& k = view.intrinsics;
      const Eigen::Vector3d ray =
          view.X_WC.linear() * Eigen::Vector3d((column - k.cx) / k.fx, (row - k.cy) / k.fy, 1);
      const double expected = (offset - normal.dot(view.X_WC.translation())) / normal.dot(ray);
      worst = std::max(worst, std::abs(depth - expected));
      ++seen;
    }
  }
  EXPECT_GT(seen, kWidth * kHeight / 2);
  EXPECT_LT(worst, 1e-4);
  std::printf("worst depth error: %.2g m over %d pixels\n", worst, seen);
}

TEST(Renderer, NearerThingsHideFartherOnesAndOverlaysBlend) {
  Renderer renderer(kWidth, kHeight);
  const auto centre = [&](const Colour& front, const Colour& back) {
    renderer.begin(view_along_x(2));
    math::Pose X = math::Pose::Identity();
    X.translation().x() = -0.5;
    renderer.draw_box(X, {0.2, 0.4, 0.4}, front);
    X.translation().x() = 0.5;
    renderer.draw_box(X, {0.2, 2, 2}, back);
    const Image& image = renderer.end();
    const std::uint8_t* pixel = image.pixel(kWidth / 2, kHeight / 2);
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  const auto opaque = centre(kRed, kBlue);
  EXPECT_GT(opaque[0], 2 * opaque[2]);
  EXPECT_NEAR(renderer.depth().at(kWidth / 2, kHeight / 2), 1.4, 1e-4);
  Colour glass = kRed;
  glass.alpha = 0.5F;
  const auto through = centre(glass, kBlue);
  EXPECT_GT(through[2], opaque[2] + 30);
  EXPECT_LT(through[0], opaque[0] - 30);
  EXPECT_NEAR(renderer.depth().at(kWidth / 2, kHeight / 2), 2.4, 1e-4);  // the opaque part
}

TEST(Renderer, SphereAndCylinderHaveTheirSilhouettes) {
  Renderer renderer(kWidth, kHeight);
  const View view = view_along_x(2);
  const double focal = view.intrinsics.fx;
  renderer.begin(view);
  renderer.draw_sphere(math::Pose::Identity(), 0.3, kRed);
  renderer.end();
  // The cone tangent to the sphere: radius r / sqrt(d^2 - r^2) at unit distance.
  const double radius = focal * 0.3 / std::sqrt(4 - 0.09);
  EXPECT_NEAR(covered(renderer.depth()).count, M_PI * radius * radius,
              0.02 * M_PI * radius * radius);
  EXPECT_NEAR(renderer.depth().at(kWidth / 2, kHeight / 2), 1.7, 2e-3);

  renderer.begin(view);
  math::Pose X = math::Pose::Identity();
  X.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  renderer.draw_cylinder(X, 0.2, 0.6, kRed);  // seen from its end
  renderer.end();
  const double disc = focal * 0.2 / 1.7;
  EXPECT_NEAR(covered(renderer.depth()).count, M_PI * disc * disc, 0.03 * M_PI * disc * disc);
}

TEST(Renderer, LinesArrowsAndVertexColoursShow) {
  Renderer renderer(kWidth, kHeight);
  renderer.begin(view_along_x(2));
  renderer.draw_line({0, -0.5, 0}, {0, 0.5, 0}, 3, kRed);
  EXPECT_TRUE(reddish(renderer.end().pixel(kWidth / 2, kHeight / 2)));
  EXPECT_EQ(covered(renderer.depth()).count, 0);

  renderer.begin(view_along_x(2));
  renderer.draw_arrow({0, 0, -0.3}, {0, 0, 0.4}, 0.03, kRed);
  const Image& picture = renderer.end();
  EXPECT_TRUE(reddish(picture.pixel(kWidth / 2, kHeight / 2)));
  const double row = kHeight / 2 - view_along_x(2).intrinsics.fy * 0.39 / 2;
  EXPECT_TRUE(reddish(picture.pixel(kWidth / 2, std::lround(row))));

  TriangleMesh box = make_box({0.5, 0.5, 0.5});
  MeshStyle style;
  for (int i = 0; i < 8; ++i) style.vertex_colours.push_back(box.points(2, i) > 0 ? kRed : kBlue);
  renderer.begin(view_along_x(2));
  renderer.draw_mesh(box.points, box.triangles, style);
  const Image& painted = renderer.end();
  EXPECT_TRUE(reddish(painted.pixel(kWidth / 2, kHeight / 2 - 30)));
  EXPECT_FALSE(reddish(painted.pixel(kWidth / 2, kHeight / 2 + 30)));
}

TEST(Renderer, PicturesAreTheSameEveryTime) {
  const auto take = [] {
    Renderer renderer(kWidth, kHeight, 2);
    renderer.begin(view_along_x(2));
    renderer.draw_sphere(math::Pose::Identity(), 0.3, kRed);
    return renderer.end().rgb;
  };
  EXPECT_EQ(take(), take());
}

TEST(Renderer, RefusesNonsense) {
  EXPECT_THROW(Renderer(0, 10), std::invalid_argument);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 0, 1}, {0, 0, 1}), std::invalid_argument);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 0, 0}, {0, 0, 1}), std::invalid_argument);
  Renderer renderer(10, 10);
  EXPECT_THROW(renderer.begin(View{}), std::invalid_argument);
  TriangleMesh box = make_box({1, 1, 1});
  MeshStyle style;
  style.vertex_colours.resize(3);
  EXPECT_THROW(renderer.draw_mesh(box.points, box.triangles, style), std::invalid_argument);
  box.triangles(0, 0) = 8;
  EXPECT_THROW(renderer.draw_mesh(box.points, box.triangles, {}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::draw
