#include "tools/fit/held/held_decay.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/fit/held_bar.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::fit {
namespace {

using Eigen::VectorXd;

/// A stop with zero readings: only its times are used.
HeldRinging silent_stop(const HeldCell& cell, const math::Vector6d& motion) {
  HeldRinging ringing;
  ringing.X_WE = make_rests(cell, {motion}).samples[0].X_WE;
  ringing.times.setLinSpaced(120, 0, 0.6);
  ringing.readings.setZero(6, 120);
  return ringing;
}

VectorXd ringing_parameters(const HeldDecay& decay) {
  VectorXd p = starts(decay);
  p[0] = 2.7e4;
  p[1] = 65;
  p[2] = 3;
  p[3] = 1e-3;
  for (Eigen::Index k = 4; k < p.size(); ++k) p[k] = 0.1 + 0.03 * static_cast<double>(k % 5);
  return p;
}

TEST(HeldDecay, FollowsEveryParameterAsItsDifferencesSay) {
  const HeldCell cell = make_held_bar();
  const std::vector<math::Vector6d> motions = six_motions();
  HeldDecayOptions options;
  options.modes = 3;
  const HeldDecay decay("bar", cell, {silent_stop(cell, motions[1]), silent_stop(cell, motions[3])},
                        options);
  EXPECT_EQ(decay.series().size(), 12u);
  expect_gradient(decay, ringing_parameters(decay), 0);
}

// Readings of the daemon's dynamic model after a stop: its damping and modulus are recovered.
TEST(HeldDecay, FindsDampingAndModulusOfTheDynamicModel) {
  HeldCell cell = make_held_bar(mesh::ElementOrder::kQuadratic);
  elasticity::Body body = cell.object.body;
  body.damping = {2.5, 1e-3};
  body.material.young_modulus = 2.2e4;  // the configuration believes 3e4
  const math::Pose rest = body.grasps[0].X_OG_rest;
  const auto still =
      elasticity::solve_static(body, Eigen::Matrix3Xd::Zero(3, body.mesh.node_count()), {rest, {}});
  elasticity::SolverOptions options;
  const double h = 1e-4;
  options.time_step = h;
  options.tolerance = 1e-9;
  options.accuracy = 1e-12;
  options.iterations = 8;
  elasticity::CorotationalDynamic model(body, options);
  model.prepare();
  model.hold(0, rest);
  ASSERT_TRUE(model.restore(still.positions, Eigen::Matrix3Xd::Zero(3, body.mesh.node_count())));
  HeldRinging ringing;
  ringing.X_WE = make_rests(cell, {math::Vector6d::Zero()}).samples[0].X_WE;
  ringing.deviation << 1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4;
  const int skip = 500, every = 50, count = 100;
  ringing.times.resize(count);
  ringing.readings.resize(6, count);
  const math::Pose X_SG = cell.frames.X_ES.inverse() * cell.frames.X_EG;
  const Eigen::Matrix3d R_SO =
      (ringing.X_WE * cell.frames.X_ES).linear().transpose() * cell.frames.X_WO.linear();
  for (int step = 0; step < skip + every * count; ++step) {
    // Up and across by 2 mm within 20 ms, then still.
    math::Pose hand = rest;
    hand.translation() += std::min(1.0, (step + 1) / 200.0) * Eigen::Vector3d(0, 0.002, 0.002);
    model.hold(0, hand);
    model.step(h);
    if (step < skip || (step - skip) % every != 0) continue;
    const int i = (step - skip) / every;
    ringing.times[i] = h * (step - skip);
    const math::Wrench w = model.reaction(0);
    const Eigen::Vector3d force = R_SO * w.force;
    ringing.readings.col(i) << force, R_SO * w.torque + X_SG.translation().cross(force);
  }
  HeldDecayOptions sought;
  sought.modes = 6;
  sought.stiffness_damping = true;
  const HeldDecay decay("bar", cell, {ringing}, sought);

  // Gauss-Newton from the best point of the scan.
  VectorXd p = starts(decay), prediction;
  EXPECT_NEAR(p[0], 2.2e4, 0.05 * 2.2e4);
  Eigen::MatrixXd J;
  VectorXd measured(decay.series().size() * count);
  for (std::size_t s = 0; s < decay.series().size(); ++s)
    measured.segment(s * count, count) = decay.series()[s].measured;
  for (int pass = 0; pass < 20; ++pass) {
    ASSERT_TRUE(decay.predict(p, prediction, &J));
    J.col(1).setZero();  // density is known
    p += J.completeOrthogonalDecomposition().solve(measured - prediction);
  }
  EXPECT_NEAR(p[0], 2.2e4, 0.01 * 2.2e4);
  const double omega = 2 * 3.14159265 * 10;  // total damping, around the lowest modes
  EXPECT_NEAR(p[2] + p[3] * omega * omega, 2.5 + 1e-3 * omega * omega,
              0.1 * (2.5 + 1e-3 * omega * omega));
}

// An oscillation of 5 Hz that starts when the hand stops after one second.
TEST(HeldRinging, BeginsWhereTheHandStops) {
  const support::ScratchFolder folder;
  const std::string file = (folder.path() / "stop.log").string();
  {
    log::EventLog log(file);
    math::Random random(1);
    for (int ms = 0; ms < 3000; ++ms) {
      robot_state_t state{};
      state.utime = 1000 * ms;
      state.position[0] = 0.1 * std::min(1e-3 * ms, 1.0);
      state.quaternion[0] = 1;
      log.write("ROBOT_STATE", state.utime, state);
      ft_wrench_t wrench{};
      wrench.utime = 1000 * ms;
      wrench.wrench[2] = std::sin(2 * 3.14159265 * 5e-3 * ms) + 0.01 * random.normal();
      log.write("FT_WRENCH", wrench.utime, wrench);
    }
  }
  const std::vector<HeldRinging> found = read_ringings(file, {}, "sent", 1.0, 200);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].time, 1.05, 0.11);
  EXPECT_EQ(found[0].times.size(), 200);
  EXPECT_NEAR(found[0].X_WE.translation().x(), 0.1, 1e-6);
  EXPECT_NEAR(found[0].deviation[2], 0.01 / std::sqrt(5), 5e-4);
  for (int i = 0; i < 200; ++i)
    EXPECT_NEAR(found[0].readings(2, i),
                std::sin(2 * 3.14159265 * 5 * (found[0].time + found[0].times[i])), 0.03);
}

}  // namespace
}  // namespace palpate::fit
