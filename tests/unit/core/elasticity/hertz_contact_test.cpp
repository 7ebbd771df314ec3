// A rigid ball on a soft block that is bonded to its base, against Hertz with the correction for
// finite thickness of Dimitriadis et al. 2002 (Biophysical Journal 82).
#include <gtest/gtest.h>

#include "core/mesh/grid_mesh.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

struct Ball {
  double ratio;    // of the contact's radius by Hertz to the ball's
  double poisson;  // Poisson's ratio of the block
};

std::ostream& operator<<(std::ostream& out, const Ball& ball) {
  return out << "a_R_" << ball.ratio << "_nu_" << ball.poisson;
}

constexpr double kRadius = 2e-3;  // m, of the contact by Hertz
constexpr double kYoung = 1e5;    // Pa

/// Force, N, on a ball of radius R pressed by `approach` into a layer of thickness h.
double dimitriadis(double R, double approach, double h, double nu) {
  const double pi = M_PI, chi = std::sqrt(R * approach) / h;
  const double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  const double a2 = a * a, a3 = a2 * a;
  const double hertz = 4 * kYoung / (3 * (1 - nu * nu)) * std::sqrt(R) * std::pow(approach, 1.5);
  return hertz * (1 - 2 * a / pi * chi + 4 * a2 / (pi * pi) * chi * chi -
                  8 / std::pow(pi, 3) * (a3 + 4 * pi * pi / 15 * b) * std::pow(chi, 3) +
                  16 * a / std::pow(pi, 4) * (a3 + 3 * pi * pi / 5 * b) * std::pow(chi, 4));
}

/// Block 40 contact radii wide and 10 deep, its upper side at z = 0, finest round the origin.
mesh::ElementMesh block() {
  const std::vector<double> across{0, 0.42, 0.84, 1.28, 2.4, 6, 20};  // contact radii
  const std::vector<double> down{-10, -5, -2.4, -1.1, -0.45, 0};
  mesh::GridPlanes planes;
  for (int axis = 0; axis < 2; ++axis) {
    for (auto it = across.rbegin(); it != across.rend(); ++it)
      if (*it > 0) planes[axis].push_back(-*it * kRadius);
    for (double plane : across) planes[axis].push_back(plane * kRadius);
  }
  for (double plane : down) planes[2].push_back(plane * kRadius);
  return mesh::make_element_mesh(mesh::make_grid(planes, mesh::CellCut::kFive),
                                 mesh::ElementOrder::kQuadratic);
}

class BallOnBlock : public ::testing::TestWithParam<Ball> {};

TEST_P(BallOnBlock, ForceAndContactRadiusAreThoseOfHertz) {
  const double R = kRadius / GetParam().ratio, nu = GetParam().poisson, h = 10 * kRadius;
  const double approach = kRadius * kRadius / R;
  Body body;
  body.mesh = block();
  body.material = {kYoung, nu, 1000};
  body.fixed_nodes = nodes_at(body.mesh, 2, -h);
  const collision::Obstacle ball{"ball", collision::Sphere{R},
                                 math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, R - approach}),
                                 0};
  SolverOptions options = with_obstacles({ball});
  options.iterations = 10;
  options.accuracy = 0;
  options.contact.reach = approach;
  options.contact.columns = 100;
  options.contact.sweeps = 200;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  StepReport report;
  for (int i = 0; i < 30 && report.status != StepStatus::kConverged; ++i) report = model.step(kDt);
  ASSERT_EQ(report.status, StepStatus::kConverged);

  const Vector3d force = contact_force(model);
  const double expected = dimitriadis(R, approach, h, nu);
  EXPECT_NEAR(-force.z(), expected, 0.05 * expected);
  EXPECT_LT(force.head<2>().norm(), 0.01 * expected);
  // Hertz' pressure has the second moment 2/5 a^2, and the radius a^3 = 3 F R (1 - nu^2) / 4 E.
  double moment = 0;
  for (const SurfaceContact& contact : model.contacts())
    moment -= contact.force.z() * contact.position.head<2>().squaredNorm();
  const double radius = std::sqrt(2.5 * moment / -force.z());
  const double hertz = std::cbrt(0.75 * -force.z() * R * (1 - nu * nu) / kYoung);
  EXPECT_NEAR(radius, hertz, 0.1 * hertz);
  EXPECT_LT(deepest(model), 2e-3 * h);
}

INSTANTIATE_TEST_SUITE_P(Balls, BallOnBlock,
                         ::testing::Values(Ball{0.1, 0.3}, Ball{0.1, 0.45}, Ball{0.2, 0.3},
                                           Ball{0.2, 0.45}));

}  // namespace
}  // namespace palpate::elasticity
