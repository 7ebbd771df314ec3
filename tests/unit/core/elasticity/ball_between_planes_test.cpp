// A soft ball pressed between two rigid planes without friction, against Hertz with the correction
// for the opposite contact of Tatara 1989, as in Liu, Williams and Briscoe 1998 (J. Phys. D 31):
// a plane approaches the centre by 3 (1 - nu^2) F / (4 E a) - f F / (pi E), with
// f = 2 (1 + nu) R^2 / (a^2 + 4 R^2)^(3/2) + (1 - nu^2) / (a^2 + 4 R^2)^(1/2).
#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/grid_mesh.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

struct SoftBall {
  double ratio;    // of the contact's radius by Hertz to the ball's
  double poisson;  // Poisson's ratio
};

std::ostream& operator<<(std::ostream& out, const SoftBall& ball) {
  return out << "a_R_" << ball.ratio << "_nu_" << ball.poisson;
}

constexpr double kContactRadius = 2e-3;  // m, by Hertz
constexpr double kBallYoung = 1e5;       // Pa

double hertz_radius(double force, double R, double nu) {
  return std::cbrt(0.75 * (1 - nu * nu) * R * force / kBallYoung);
}

/// Approach of a plane to the centre, m, at a force, N.
double tatara(double force, double R, double nu) {
  const double a = hertz_radius(force, R, nu), reach = std::sqrt(a * a + 4 * R * R);
  const double opposite = 2 * (1 + nu) * R * R / (reach * reach * reach) + (1 - nu * nu) / reach;
  return 0.75 * (1 - nu * nu) * force / (kBallYoung * a) - opposite * force / (M_PI * kBallYoung);
}

/// The force, N, whose approach by tatara() is that.
double force_at(double approach, double R, double nu) {
  double below = 0, above = kBallYoung * R * R;
  for (int i = 0; i < 100; ++i) {
    const double middle = (below + above) / 2;
    (tatara(middle, R, nu) < approach ? below : above) = middle;
  }
  return below;
}

/// Planes of a grid of the cube [-1, 1]^3 at positive coordinates, mirrored.
std::vector<double> mirrored(const std::vector<double>& planes) {
  std::vector<double> all{0};
  for (double plane : planes) all.insert(all.end(), {plane, -plane});
  std::sort(all.begin(), all.end());
  return all;
}

/// About the origin, finest at the ends of its axis z.
mesh::ElementMesh soft_ball(double R) {
  std::vector<double> across, along;
  // At the ends a step of the grid across is shortened by sqrt(1/2).
  for (double radii : {0.4, 0.8, 1.25, 2.4, 6.0}) {
    const double plane = radii * kContactRadius / (std::sqrt(0.5) * R);
    if (plane < 0.85) across.push_back(plane);
  }
  for (double radii : {6.0, 2.4, 1.1, 0.45}) {
    const double plane = 1 - radii * kContactRadius / R;
    if (plane > 0.15) along.push_back(plane);
  }
  across.push_back(1);
  along.push_back(1);
  mesh::TetrahedralMesh grid =
      mesh::make_grid({mirrored(across), mirrored(across), mirrored(along)}, mesh::CellCut::kFive);
  for (auto node : grid.nodes.colwise()) {
    const Eigen::Array3d square = node.array().square();
    const auto scale = [&](int i, int j) {
      return std::sqrt(1 - square[i] / 2 - square[j] / 2 + square[i] * square[j] / 3);
    };
    node = R * Vector3d(node.x() * scale(1, 2), node.y() * scale(2, 0), node.z() * scale(0, 1));
  }
  return mesh::make_element_mesh(grid, mesh::ElementOrder::kQuadratic);
}

class BallBetweenPlanes : public ::testing::TestWithParam<SoftBall> {};

TEST_P(BallBetweenPlanes, ForceAndContactRadiusAreThoseOfTatara) {
  const double R = kContactRadius / GetParam().ratio, nu = GetParam().poisson;
  const double approach = kContactRadius * kContactRadius / R;
  Body body;
  body.mesh = soft_ball(R);
  body.material = {kBallYoung, nu, 1000};
  // The middle alone, against rigid motion.
  for (int i = 0; i < static_cast<int>(body.mesh.nodes.cols()); ++i) {
    const Vector3d node = body.mesh.nodes.col(i);
    if (node.norm() < 0.25 * kContactRadius) body.fixed_nodes.push_back(i);
  }
  ASSERT_GE(body.fixed_nodes.size(), 3U);
  const double height = R - approach;
  SolverOptions options =
      with_obstacles({plane({0, 0, -height}, {0, 0, 1}, 0), plane({0, 0, height}, {0, 0, -1}, 0)});
  options.iterations = 10;
  options.accuracy = 0;
  options.contact.reach = approach;
  options.contact.columns = 240;
  options.contact.sweeps = 200;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  StepReport report;
  for (int i = 0; i < 30 && report.status != StepStatus::kConverged; ++i) report = model.step(kDt);
  ASSERT_EQ(report.status, StepStatus::kConverged);

  const double expected = force_at(approach, R, nu);
  for (const double side : {-1.0, 1.0}) {
    double force = 0, moment = 0;
    for (const SurfaceContact& contact : model.contacts()) {
      if (side * contact.position.z() < 0) continue;
      force -= side * contact.force.z();
      moment -= side * contact.force.z() * contact.position.head<2>().squaredNorm();
    }
    EXPECT_NEAR(force, expected, 0.05 * expected) << side;
    // Hertz' pressure has the second moment 2/5 a^2.
    const double radius = std::sqrt(2.5 * moment / force), hertz = hertz_radius(force, R, nu);
    EXPECT_NEAR(radius, hertz, 0.1 * hertz) << side;
  }
  EXPECT_LT(deepest(model), 2e-3 * 2 * R);
}

INSTANTIATE_TEST_SUITE_P(Balls, BallBetweenPlanes,
                         ::testing::Values(SoftBall{0.1, 0.3}, SoftBall{0.1, 0.45},
                                           SoftBall{0.2, 0.3}, SoftBall{0.2, 0.45}));

}  // namespace
}  // namespace palpate::elasticity
