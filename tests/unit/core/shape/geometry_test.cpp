// Scalar features of the geometry: distance, angle, curvature, Fourier coefficients, and the whole
// surface.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/mesh/surface.hpp"
#include "core/shape/angle_feature.hpp"
#include "core/shape/curvature_feature.hpp"
#include "core/shape/fourier_contour_feature.hpp"
#include "core/shape/point_features.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/shape/shapes.hpp"

namespace palpate::shape {
namespace {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Points = std::vector<Vector3d>;

constexpr double kGeometryNan = std::numeric_limits<double>::quiet_NaN();
constexpr auto kLinear = mesh::ElementOrder::kLinear;
constexpr auto kQuadratic = mesh::ElementOrder::kQuadratic;

/// Along the bar, on its upper side.
Points line(int count) {
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(0.1 + 0.08 * i, 0.03, 0.06);
  return points;
}

/// Off any line.
Points crooked(int count) {
  Points points = line(count);
  for (int i = 0; i < count; ++i) points[i].z() -= 0.012 * (i % 2) + 0.003 * i * i;
  return points;
}

/// Around the bar at mid-length, uniformly spaced.
Points ring(int each_side) {
  const Vector3d corners[] = {{0.25, 0, 0}, {0.25, 0.06, 0}, {0.25, 0.06, 0.06}, {0.25, 0, 0.06}};
  Points points;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < each_side; ++i) {
      const double part = static_cast<double>(i) / each_side;
      points.push_back((1 - part) * corners[side] + part * corners[(side + 1) % 4]);
    }
  }
  return points;
}

std::vector<std::unique_ptr<Feature>> features(const mesh::ElementMesh& mesh) {
  std::vector<std::unique_ptr<Feature>> made;
  made.push_back(std::make_unique<DistanceFeature>(mesh, DistanceFeature::Options{line(2)}));
  made.push_back(std::make_unique<AngleFeature>(mesh, AngleFeature::Options{crooked(3), {}}));
  made.push_back(std::make_unique<AngleFeature>(mesh, AngleFeature::Options{crooked(4), {}}));
  made.push_back(
      std::make_unique<AngleFeature>(mesh, AngleFeature::Options{line(3), Vector3d(0.3, 2, 0.5)}));
  made.push_back(
      std::make_unique<AngleFeature>(mesh, AngleFeature::Options{line(4), Vector3d(0, 0.2, 3)}));
  for (const int count : {3, 5}) {
    made.push_back(
        std::make_unique<CurvatureFeature>(mesh, CurvatureFeature::Options{crooked(count), {}}));
    made.push_back(std::make_unique<CurvatureFeature>(
        mesh, CurvatureFeature::Options{line(count), Vector3d(0, -1, 0.4)}));
  }
  made.push_back(std::make_unique<FourierContourFeature>(
      mesh, FourierContourFeature::Options{ring(5), 4, true, {1, 2}}));
  made.push_back(std::make_unique<FourierContourFeature>(
      mesh, FourierContourFeature::Options{line(5), 2, false, {0, 1, 2}}));
  made.push_back(
      std::make_unique<PointsFeature>(mesh, PointsFeature::Options{surface_points(mesh, 40)}));
  return made;
}

double value_of(Feature& feature, const Matrix3Xd& positions) {
  VectorXd value(feature.value_count());
  feature.evaluate(positions, value);
  return value[0];
}

/// The bar bent in the plane of x and z to a circle of this curvature, towards +z where positive;
/// lines along x at height z keep z as the distance from the arc of the bottom.
Matrix3Xd bent(const Matrix3Xd& rest, double curvature) {
  const double radius = 1 / curvature;
  Matrix3Xd x = rest;
  for (int i = 0; i < x.cols(); ++i) {
    const double angle = curvature * rest(0, i);
    x(0, i) = (radius - rest(2, i)) * std::sin(angle);
    x(2, i) = radius - (radius - rest(2, i)) * std::cos(angle);
  }
  return x;
}

TEST(GeometryFeatures, JacobiansEqualCentralDifferences) {
  for (const auto order : {kLinear, kQuadratic}) {
    const mesh::ElementMesh mesh = bar(order);
    for (const auto& feature : features(mesh)) {
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        EXPECT_LT(jacobian_error(*feature, deformed(mesh, seed)), 1e-6)
            << feature->kind() << " of " << feature->rest_points().size() << ", seed " << seed;
        EXPECT_TRUE(feature->is_defined());
      }
    }
  }
}

TEST(GeometryFeatures, AreFiniteWhateverTheShape) {
  const mesh::ElementMesh mesh = bar(kLinear);
  for (const auto& feature : features(mesh)) {
    const bool is_linear = std::string(feature->kind()) == "points" ||
                           std::string(feature->kind()) == "fourier_contour";
    VectorXd value(feature->value_count());
    feature->evaluate(deformed(mesh), value);
    const MatrixXd sound = feature->jacobian();
    for (const bool into_a_point : {true, false}) {
      Matrix3Xd flat = mesh.nodes;
      flat.bottomRows<2>().setZero();
      if (into_a_point) flat.setZero();
      feature->evaluate(flat, value);
      EXPECT_TRUE(value.allFinite()) << feature->kind();
      EXPECT_TRUE(MatrixXd(feature->jacobian()).allFinite()) << feature->kind();
      EXPECT_GT(MatrixXd(feature->jacobian()).cwiseAbs().maxCoeff(), 0) << feature->kind();
      if (into_a_point) {
        EXPECT_EQ(feature->is_defined(), is_linear) << feature->kind();
        EXPECT_EQ(MatrixXd(feature->jacobian()), sound) << feature->kind();
      }
    }
    feature->evaluate(deformed(mesh), value);
    EXPECT_TRUE(feature->is_defined()) << feature->kind();
    EXPECT_LT((MatrixXd(feature->jacobian()) - sound).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(GeometryFeatures, EvaluateWithoutAllocating) {
  if (loop::allocations_of_this_thread() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  const mesh::ElementMesh mesh = bar(kQuadratic);
  const Matrix3Xd x = deformed(mesh);
  for (const auto& feature : features(mesh)) {
    VectorXd value(feature->value_count()), error(feature->dimension());
    const loop::NoAllocationScope scope;
    feature->evaluate(x, value);
    feature->error(value, value, error);
    EXPECT_EQ(scope.count(), 0) << feature->kind();
  }
}

// Quantities invariant under a rigid motion: distance, angle and curvature of the material itself.
TEST(GeometryFeatures, OfTheMaterialIgnoreRigidMotions) {
  const mesh::ElementMesh mesh = bar(kLinear);
  const Matrix3Xd x = deformed(mesh);
  const math::Pose X =
      math::make_pose(math::exp_rotation({1.1, -0.7, 2.0}), Vector3d(0.3, -0.2, 0.1));
  const Matrix3Xd moved = (X.linear() * x).colwise() + X.translation();
  DistanceFeature distance(mesh, {line(2)});
  AngleFeature angle(mesh, {crooked(3), {}});
  CurvatureFeature curvature(mesh, {crooked(5), {}});
  for (Feature* feature : {static_cast<Feature*>(&distance), static_cast<Feature*>(&angle),
                           static_cast<Feature*>(&curvature)}) {
    const double before = value_of(*feature, x);
    EXPECT_NEAR(value_of(*feature, moved), before, 1e-9 * before) << feature->kind();
  }
}

TEST(DistanceFeature, GrowsWithTheBar) {
  const mesh::ElementMesh mesh = bar(kLinear);
  DistanceFeature feature(mesh, {{{0.1, 0.03, 0.06}, {0.4, 0.03, 0.02}}});
  EXPECT_NEAR(value_of(feature, mesh.nodes), std::hypot(0.3, 0.04), 1e-12);
  EXPECT_NEAR(value_of(feature, 1.5 * mesh.nodes), 1.5 * std::hypot(0.3, 0.04), 1e-12);
  const double good = 0.1, negative = -0.1;
  EXPECT_TRUE(feature.is_valid_target(&good, 1));
  EXPECT_FALSE(feature.is_valid_target(&negative, 1));
  EXPECT_FALSE(feature.is_valid_target(&kGeometryNan, 1));
  EXPECT_THROW(DistanceFeature(mesh, {{{0.1, 0.03, 0.06}, {0.1, 0.0305, 0.06}}}),
               std::invalid_argument);
  EXPECT_THROW(DistanceFeature(mesh, {line(3)}), std::invalid_argument);
}

TEST(AngleFeature, IsThatBetweenTheDirections) {
  const mesh::ElementMesh mesh = bar(kLinear);
  const Points corner = {{0.3, 0.03, 0}, {0.25, 0.03, 0}, {0.25 + 0.04, 0.03, 0.04}};
  AngleFeature at_a_point(mesh, {corner, {}});
  EXPECT_NEAR(value_of(at_a_point, mesh.nodes), M_PI / 4, 1e-12);
  // Of two directions anywhere, even of one line in both directions.
  AngleFeature between(
      mesh, {{{0.1, 0.03, 0.03}, {0.2, 0.03, 0.03}, {0.4, 0.01, 0.01}, {0.4, 0.05, 0.01}}, {}});
  EXPECT_NEAR(value_of(between, mesh.nodes), M_PI / 2, 1e-12);
}

TEST(AngleFeature, CountsAboutItsAxisThroughTheStraightLine) {
  const mesh::ElementMesh mesh = bar(kLinear);
  const Points two = {{0.05, 0.03, 0.03}, {0.1, 0.03, 0.03}, {0.4, 0.03, 0.03}, {0.45, 0.03, 0.03}};
  AngleFeature feature(mesh, {two, Vector3d(0, -2, 0)});  // x turns towards z about -y
  EXPECT_NEAR(value_of(feature, mesh.nodes), 0, 1e-12);
  EXPECT_TRUE(feature.is_defined());
  for (const double turn : {-2.0, -0.3, 0.3, 2.0, 3.1}) {
    Matrix3Xd x = mesh.nodes;
    for (int i = 0; i < x.cols(); ++i) {
      // Rotated about y beyond mid-length, so that the first pair is unaffected.
      if (x(0, i) > 0.3) {
        x.col(i) = math::exp_rotation({0, -turn, 0}) * Vector3d(x.col(i) - Vector3d(0.4, 0, 0));
      }
    }
    EXPECT_NEAR(value_of(feature, x), turn, 1e-9);
  }
  VectorXd error(1);
  feature.error(VectorXd::Constant(1, 3.0), VectorXd::Constant(1, -3.0), error);
  EXPECT_NEAR(error[0], 2 * M_PI - 6, 1e-12);
  feature.error(VectorXd::Constant(1, -3.0), VectorXd::Constant(1, 3.0), error);
  EXPECT_NEAR(error[0], 6 - 2 * M_PI, 1e-12);
  const double negative = -1, far = 3.2;
  EXPECT_TRUE(feature.is_valid_target(&negative, 1));
  EXPECT_FALSE(feature.is_valid_target(&far, 1));
  EXPECT_FALSE(AngleFeature(mesh, {crooked(3), {}}).is_valid_target(&negative, 1));
}

TEST(AngleFeature, RefusesWhatHasNoAngle) {
  const mesh::ElementMesh mesh = bar(kLinear);
  EXPECT_THROW(AngleFeature(mesh, {line(3), {}}), std::invalid_argument);
  EXPECT_THROW(AngleFeature(mesh, {line(3), Vector3d(1, 0, 0)}), std::invalid_argument);
  EXPECT_THROW(AngleFeature(mesh, {line(3), Vector3d(0, 0, 0)}), std::invalid_argument);
  EXPECT_THROW(AngleFeature(mesh, {crooked(2), {}}), std::invalid_argument);
  EXPECT_THROW(AngleFeature(mesh, {crooked(5), {}}), std::invalid_argument);
  EXPECT_NO_THROW(AngleFeature(mesh, {line(3), Vector3d(0, 1, 0)}));
}

TEST(CurvatureFeature, IsThatOfTheCircle) {
  // Many elements, since points are interpolated linearly between nodes.
  const mesh::ElementMesh mesh =
      mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, {25, 1, 1}), kLinear);
  const Points three = {{0.1, 0, 0}, {0.18, 0, 0}, {0.4, 0, 0}};  // on nodes, non-uniformly
  const Points five = {{0.06, 0, 0}, {0.1, 0, 0}, {0.24, 0, 0}, {0.3, 0, 0}, {0.48, 0, 0}};
  for (const Points& points : {three, five}) {
    CurvatureFeature about(mesh, {points, Vector3d(0, -1, 0)});
    EXPECT_NEAR(value_of(about, mesh.nodes), 0, 1e-12);
    EXPECT_TRUE(about.is_defined());
    for (const double curvature : {-6.0, -0.5, 1e-3, 0.5, 6.0}) {
      EXPECT_NEAR(value_of(about, bent(mesh.nodes, curvature)), curvature, 1e-9);
    }
  }
}

TEST(CurvatureFeature, WithoutAnAxisHasNoSign) {
  const mesh::ElementMesh mesh = bar(kLinear);
  const Points points = {{0.1, 0.03, 0.02}, {0.2, 0.03, 0.0}, {0.3, 0.03, 0.02}};
  CurvatureFeature feature(mesh, {points, {}});
  CurvatureFeature opposed(mesh, {{points[2], points[1], points[0]}, {}});
  // Circle over a chord of 0.2 m with a sagitta of 0.02 m.
  const double radius = (0.1 * 0.1 + 0.02 * 0.02) / 0.04;
  EXPECT_NEAR(value_of(feature, mesh.nodes), 1 / radius, 1e-9);
  EXPECT_NEAR(value_of(opposed, mesh.nodes), 1 / radius, 1e-9);
  Matrix3Xd straight = mesh.nodes;
  straight.row(2).setZero();
  EXPECT_NEAR(value_of(feature, straight), 0, 1e-12);
  EXPECT_FALSE(feature.is_defined());
  const double negative = -1;
  EXPECT_FALSE(feature.is_valid_target(&negative, 1));
  EXPECT_TRUE(CurvatureFeature(mesh, {points, Vector3d(0, 1, 0)}).is_valid_target(&negative, 1));
}

TEST(CurvatureFeature, RefusesWhatHasNoCurvature) {
  const mesh::ElementMesh mesh = bar(kLinear);
  EXPECT_THROW(CurvatureFeature(mesh, {line(3), {}}), std::invalid_argument);
  EXPECT_THROW(CurvatureFeature(mesh, {line(4), Vector3d(0, 1, 0)}), std::invalid_argument);
  EXPECT_THROW(CurvatureFeature(mesh, {crooked(2), {}}), std::invalid_argument);
  Points folded = crooked(3);
  folded[2] = folded[0];
  EXPECT_THROW(CurvatureFeature(mesh, {folded, {}}), std::invalid_argument);
}

TEST(FourierContour, IsLinearInThePositions) {
  const mesh::ElementMesh mesh = bar(kLinear);
  const Points points = ring(6);
  FourierContourFeature feature(mesh, {points, 2, true, {1, 2}});
  ASSERT_EQ(feature.dimension(), 10);
  const MatrixXd J = feature.jacobian();
  VectorXd rest(10), value(10);
  feature.evaluate(mesh.nodes, rest);
  EXPECT_NEAR(rest[0], 0.03, 1e-12);  // mean y and z of the square
  EXPECT_NEAR(rest[5], 0.03, 1e-12);
  Matrix3Xd x = deformed(mesh);
  VectorXd move(3 * feature.support().size());
  for (std::size_t i = 0; i < feature.support().size(); ++i) {
    move.segment<3>(3 * static_cast<int>(i)) =
        x.col(feature.support()[i]) - mesh.nodes.col(feature.support()[i]);
  }
  feature.evaluate(x, value);
  EXPECT_LT((value - rest - J * move).norm(), 1e-12);
}

// On separate tetrahedra the points can be placed anywhere.
TEST(FourierContour, FindsTheWavesThatMadeTheContour) {
  constexpr int kPoints = 16;
  for (const bool closed : {true, false}) {
    // At rest uniformly along a circle or a line, so that s is known.
    mesh::TetrahedralMesh separate;
    separate.nodes.resize(3, 4 * kPoints);
    separate.tetrahedra.resize(4, kPoints);
    Points rest;
    for (int p = 0; p < kPoints; ++p) {
      const double angle = 2 * M_PI * p / kPoints;
      rest.push_back(closed ? Vector3d(std::cos(angle), std::sin(angle), 0) : Vector3d(p, 0, 0));
      separate.nodes.middleCols<4>(4 * p) << rest[p], rest[p] + Vector3d(0.1, 0, 0),
          rest[p] + Vector3d(0, 0.1, 0), rest[p] + Vector3d(0, 0, 0.1);
      separate.tetrahedra.col(p) << 4 * p, 4 * p + 1, 4 * p + 2, 4 * p + 3;
    }
    const mesh::ElementMesh mesh = mesh::make_element_mesh(separate, kLinear);
    FourierContourFeature feature(mesh, {rest, 2, closed, {2, 0}});
    math::Random random(3);
    const int each = feature.dimension() / 2;
    ASSERT_EQ(each, closed ? 5 : 3);
    VectorXd made(2 * each);
    for (int i = 0; i < made.size(); ++i) made[i] = random.normal();
    Matrix3Xd x = Matrix3Xd::Constant(3, mesh.nodes.cols(), 7.0);
    for (int p = 0; p < kPoints; ++p) {
      for (int c = 0; c < 2; ++c) {
        const auto a = made.segment(c * each, each);
        const double s = closed ? 2 * M_PI * p / kPoints : M_PI * p / (kPoints - 1);
        x(c == 0 ? 2 : 0, 4 * p) = closed ? a[0] + a[1] * std::cos(s) + a[2] * std::sin(s) +
                                                a[3] * std::cos(2 * s) + a[4] * std::sin(2 * s)
                                          : a[0] + a[1] * std::cos(s) + a[2] * std::cos(2 * s);
      }
    }
    VectorXd value(2 * each);
    feature.evaluate(x, value);
    EXPECT_LT((value - made).norm(), 1e-12) << (closed ? "closed" : "open");
  }
}

TEST(FourierContour, RefusesIndistinguishableHarmonics) {
  const mesh::ElementMesh mesh = bar(kLinear);
  using Options = FourierContourFeature::Options;
  EXPECT_NO_THROW(FourierContourFeature(mesh, Options{ring(2), 3, true, {1, 2}}));
  EXPECT_THROW(FourierContourFeature(mesh, Options{ring(2), 4, true, {1, 2}}),
               std::invalid_argument);
  EXPECT_THROW(FourierContourFeature(mesh, Options{ring(2), 0, true, {1, 2}}),
               std::invalid_argument);
  EXPECT_THROW(FourierContourFeature(mesh, Options{ring(2), 2, true, {1, 1}}),
               std::invalid_argument);
  EXPECT_THROW(FourierContourFeature(mesh, Options{line(2), 1, false, {0, 1, 2}}),
               std::invalid_argument);
  // Seven points, but all of them at one end.
  Points crowded;
  for (int i = 0; i < 6; ++i) crowded.emplace_back(0.1 + 0.002 * i, 0.03, 0.06);
  crowded.emplace_back(0.5, 0.03, 0.06);
  EXPECT_THROW(FourierContourFeature(mesh, Options{crowded, 3, true, {0, 1, 2}}),
               std::invalid_argument);
}

TEST(SurfacePoints, AreSpreadOverTheWholeSurface) {
  const mesh::ElementMesh mesh = bar(kQuadratic);
  const Points points = surface_points(mesh, 40);
  ASSERT_EQ(points.size(), 40u);
  double nearest = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d& p = points[i];
    const bool on_a_side =
        p.x() == 0 || p.x() == 0.5 || p.y() == 0 || p.y() == 0.06 || p.z() == 0 || p.z() == 0.06;
    EXPECT_TRUE(on_a_side) << p.transpose();
    for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, (p - points[k]).norm());
  }
  EXPECT_EQ(points[0], Vector3d(0, 0, 0));
  EXPECT_GT(nearest, 0.029);
  // Corners of the box are among the first.
  EXPECT_EQ(points[1], Vector3d(0.5, 0.06, 0.06));
  const Points fewer = surface_points(mesh, 10);
  EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), points.begin()));
  // 7 x 3 x 3 corner nodes, 5 of them inside.
  EXPECT_EQ(surface_points(mesh, 1000).size(), 58u);
}

TEST(SurfacePoints, AreSpreadOverAPartOfTheSurface) {
  const mesh::ElementMesh mesh = bar(kQuadratic);
  const Eigen::Matrix3Xi whole = mesh::extract_surface(mesh).triangles;
  std::vector<int> top;
  for (int t = 0; t < whole.cols(); ++t) {
    bool is_top = true;
    for (const int n : whole.col(t)) is_top = is_top && mesh.nodes(2, n) == 0.06;
    if (is_top) top.push_back(t);
  }
  const Eigen::Matrix3Xi part = whole(Eigen::all, top);
  // 7 x 3 corner nodes.
  const Points points = surface_points(mesh, part, 1000);
  EXPECT_EQ(points.size(), 21u);
  for (const Vector3d& p : points) EXPECT_EQ(p.z(), 0.06);
  const Points two = surface_points(mesh, part, 2);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0], Vector3d(0, 0, 0.06));
  EXPECT_EQ(two[1], Vector3d(0.5, 0.06, 0.06));
  EXPECT_EQ(surface_points(mesh, whole, 40), surface_points(mesh, 40));
}

}  // namespace
}  // namespace palpate::shape
