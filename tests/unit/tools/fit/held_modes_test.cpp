#include "tools/fit/held/held_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/elasticity/corotational_model.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::fit {
namespace {

constexpr double kLength = 0.4, kSide = 0.04, kYoung = 1e5, kDensity = 100;

elasticity::Body slender_bar(double nu) {
  return elasticity::make_bar({kLength, kSide, kSide}, {12, 1, 1}, mesh::ElementOrder::kQuadratic,
                              {kYoung, nu, kDensity});
}

// A bar between clamp and hand: the first longitudinal mode has omega = pi / L sqrt(E / rho), and
// the lowest of bending, in two directions, 22.37 / L^2 sqrt(E I / rho A) minus the effect of shear
// and rotary inertia (about 6 % at L / h = 10).
TEST(HeldModes, AreThoseOfABeamClampedAtBothEnds) {
  const elasticity::Body body = slender_bar(0);
  const HeldModes modes = find_modes(body, body.grasps[0].X_OG_rest, body.mesh.nodes, 8);
  const double bending =
      22.37 / (kLength * kLength) * std::sqrt(kYoung * kSide * kSide / 12 / kDensity);
  EXPECT_NEAR(modes.frequencies[0], 0.94 * bending, 0.03 * bending);
  EXPECT_NEAR(modes.frequencies[1], modes.frequencies[0], 0.01 * bending);
  const double longitudinal = 3.14159265 / kLength * std::sqrt(kYoung / kDensity);
  double nearest = 1e9;
  for (double omega : modes.frequencies)
    nearest = std::min(nearest, std::abs(omega - longitudinal));
  EXPECT_LT(nearest, 0.01 * longitudinal);
}

// The hand stops instantly: the vibration of its wrench equals that of the daemon's dynamic model
// integrated in small steps, whose own damping is a hundredth.
TEST(HeldModes, RingAsTheDynamicModelDoes) {
  elasticity::Body body = slender_bar(0.3);
  body.damping = {3.0, 2e-3};
  const math::Pose rest = body.grasps[0].X_OG_rest;
  const HeldModes modes = find_modes(body, rest, body.mesh.nodes, 12);
  // The object follows the hand's steady motion up.
  elasticity::StaticSolver solver(body);
  solver.solve(Eigen::Matrix3Xd::Zero(3, body.mesh.node_count()), {rest, {}});
  const auto following = solver.response().dx_dxi[0];
  const double speed = 0.01, h = 4e-5;
  Eigen::Matrix3Xd velocities(3, body.mesh.node_count());
  for (int i = 0; i < velocities.cols(); ++i)
    velocities.col(i) = speed * following.block<3, 1>(3 * i, 2);
  elasticity::SolverOptions options;
  options.time_step = h;
  options.tolerance = 1e-9;
  options.accuracy = 1e-12;
  options.iterations = 10;
  elasticity::CorotationalDynamic model(body, options);
  model.prepare();
  model.hold(0, rest);
  ASSERT_TRUE(model.restore(body.mesh.nodes, velocities));
  math::Pose stop = rest;
  stop.translation().z() += h * speed;
  model.hold(0, stop);
  model.step(h);
  double squares = 0, differences = 0;
  for (int step = 1; step <= 8000; ++step) {
    model.step(h);
    if (step < 2500) continue;  // those above the twelfth have decayed
    double expected = 0;
    for (int i = 0; i < 12; ++i) {
      const double omega = modes.frequencies[i];
      const double decay =
          0.5 * (body.damping.mass_factor + body.damping.stiffness_factor * omega * omega);
      const double ringing = std::sqrt(omega * omega - decay * decay), t = step * h;
      const double start = modes.stops(i, 2) * speed;
      const double q = start / ringing * std::exp(-decay * t) * std::sin(ringing * t);
      const double rate = start * std::exp(-decay * t) *
                          (std::cos(ringing * t) - decay / ringing * std::sin(ringing * t));
      expected += modes.wrenches(2, i) * (q + body.damping.stiffness_factor * rate);
    }
    squares += expected * expected;
    differences += std::pow(model.reaction(0).force.z() - expected, 2);
  }
  EXPECT_LT(std::sqrt(differences / squares), 0.05);
}

}  // namespace
}  // namespace palpate::fit
