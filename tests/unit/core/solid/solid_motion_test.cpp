#include "core/solid/solid_motion.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

const Vector3d kBar(0.1, 0.01, 0.01);
constexpr double kE = 2e5, kNu = 0.3, kDensity = 1000;

class SolidMotionTest : public ::testing::Test {
 protected:
  SolidMotionTest()
      : mesh_(mesh::make_element_mesh(mesh::make_box(kBar, {6, 2, 2}),
                                      mesh::ElementOrder::kQuadratic)),
        body_(mesh_, elasticity::nodes_at(mesh_, 0, 0)),
        solver_(body_) {
    problem_.coefficients = make_solid_material(kE, kNu).coefficients;
    problem_.density = kDensity;
    problem_.loads = Matrix3Xd::Zero(3, mesh_.node_count());
  }

  /// Released from the position held by `force` (N, up) at the end.
  Matrix3Xd pulled(double force) {
    Matrix3Xd x = mesh_.nodes;
    EXPECT_TRUE(
        solver_.solve(problem_.coefficients,
                      elasticity::face_load(mesh_, kBar.x(), {0, 0, force}) + problem_.loads, x));
    return x;
  }
  double tip(const Matrix3Xd& x) const {
    return elasticity::face_displacement(mesh_, kBar.x(), x).z();
  }

  mesh::ElementMesh mesh_;
  SolidBody body_;
  SolidSolver solver_;
  SolidMotionProblem problem_;
};

/// Euler-Bernoulli's first frequency of a slender cantilever, within the effect of shear, rotary
/// inertia and the mesh; energy is conserved.
TEST_F(SolidMotionTest, SwingsAtTheFirstFrequencyAndKeepsItsEnergy) {
  const double radius2 = kBar.z() * kBar.z() / 12;
  const double omega = std::pow(1.8751 / kBar.x(), 2) * std::sqrt(kE * radius2 / kDensity);
  const double period = 2 * M_PI / omega, h = period / 100;
  SolidMotion motion(solver_, problem_, pulled(1e-3), h, {});
  const double begin = motion.energy(), start = tip(motion.positions());
  std::vector<double> crossings;
  double before = start;
  for (int i = 1; i <= 320; ++i) {
    ASSERT_TRUE(motion.advance());
    const double now = tip(motion.positions());
    if (before < 0 && now >= 0) crossings.push_back((i - now / (now - before)) * h);
    before = now;
    EXPECT_NEAR(motion.energy(), begin, 1e-3 * begin);
  }
  ASSERT_GE(crossings.size(), 3u);
  EXPECT_NEAR((crossings[2] - crossings[0]) / 2 / period, 1.01, 0.015);
}

/// A mass far larger than the bar's oscillates on its static stiffness.
TEST_F(SolidMotionTest, CarriesAMassAtItsEnd) {
  const double mass = 1;
  problem_.nodal_mass = mass / 9 * Eigen::VectorXd::Zero(mesh_.node_count());
  const Eigen::VectorXd areas = elasticity::face_areas(mesh_, kBar.x());
  problem_.nodal_mass = mass / areas.sum() * areas;
  const double force = 1e-3, start = tip(pulled(force));
  const double period = 2 * M_PI * std::sqrt(mass * start / force), h = period / 100;
  SolidMotion motion(solver_, problem_, pulled(force), h, {});
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(motion.advance());
  EXPECT_NEAR(tip(motion.positions()) / start, -1, 0.02);
}

/// Amplitudes decay by exp(-zeta omega t) with zeta = a / (2 omega) + b omega / 2.
TEST_F(SolidMotionTest, DampingIsRayleighs) {
  const double radius2 = kBar.z() * kBar.z() / 12;
  const double omega = std::pow(1.8751 / kBar.x(), 2) * std::sqrt(kE * radius2 / kDensity);
  problem_.damping = {0.05 * omega, 0.05 / omega};
  const double h = 2 * M_PI / omega / 100;
  SolidMotion motion(solver_, problem_, pulled(1e-3), h, {});
  std::vector<double> peaks;
  double last = 0, now = tip(motion.positions());
  for (int i = 0; i < 330 && peaks.size() < 3; ++i) {
    ASSERT_TRUE(motion.advance());
    const double next = tip(motion.positions());
    if (now > last && now > next && last != 0) peaks.push_back(now);
    last = now;
    now = next;
  }
  ASSERT_EQ(peaks.size(), 3u);
  EXPECT_NEAR(std::log(peaks[0] / peaks[2]) / (2 * 2 * M_PI * 0.05), 1, 0.03);
}

TEST_F(SolidMotionTest, SlopesMatchCentralDifferences) {
  problem_.damping = {2, 0.002};
  const Matrix3Xd weight = Vector3d(0, 0, -9.81) * body_.nodal_volume().transpose();
  const double h = 5e-3;
  const auto run = [&](const std::array<double, 5>& by, std::vector<SolidSlope> slopes) {
    SolidMotionProblem p = problem_;
    p.coefficients = make_solid_material(kE + by[0], kNu + by[1]).coefficients;
    p.density = kDensity + by[2];
    p.loads = p.density * weight;
    p.damping.mass_factor += by[3];
    p.damping.stiffness_factor += by[4];
    auto motion = std::make_unique<SolidMotion>(solver_, p, mesh_.nodes, h, std::move(slopes));
    for (int i = 0; i < 12; ++i) EXPECT_TRUE(motion->advance());
    return motion;
  };
  const SolidMaterial m = make_solid_material(kE, kNu);
  std::vector<SolidSlope> slopes(5);
  slopes[0].coefficients = m.by_young;
  slopes[1].coefficients = m.by_poisson;
  slopes[2].load = weight;
  slopes[2].density = 1;
  slopes[3].mass_factor = 1;
  slopes[4].stiffness_factor = 1;
  const auto analytic = run({}, slopes);
  ASSERT_GT((analytic->positions() - mesh_.nodes).cwiseAbs().maxCoeff(), 0.05 * kBar.x());
  const double steps[] = {1e-4 * kE, 1e-4, 1e-4 * kDensity, 1e-3, 1e-6};
  for (int p = 0; p < 5; ++p) {
    std::array<double, 5> by{};
    by[p] = steps[p];
    const Matrix3Xd ahead = run(by, {})->positions();
    by[p] = -steps[p];
    const Matrix3Xd slope = (ahead - run(by, {})->positions()) / (2 * steps[p]);
    EXPECT_LT((analytic->position_slope(p) - slope).norm(), 1e-6 * slope.norm()) << p;
  }
}

}  // namespace
}  // namespace palpate::solid
