#pragma once

#include "core/math/random.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/tools/fit/gradient.hpp"
#include "tools/fit/held/held_object.hpp"

namespace palpate::fit {

/// A small bar, clamped at one end and held at the other, in a workcell whose frames are all
/// rotated.
inline HeldCell make_held_bar(mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  HeldCell cell;
  cell.frames.X_WO = math::make_pose(math::exp_rotation({0.1, -0.2, 2.5}), {0.8, 0.1, 0.3});
  cell.frames.X_ES = math::make_pose(math::exp_rotation({0, 0.1, 0.4}), {0, 0, 0.04});
  cell.frames.X_EG = math::make_pose(math::exp_rotation({0.3, 1.2, -0.4}), {0.02, 0, 0.3});
  registry::Object& object = cell.object;
  object.corners = mesh::make_box({0.2, 0.05, 0.04}, {4, 1, 1});
  object.body = elasticity::make_bar({0.2, 0.05, 0.04}, {4, 1, 1}, order, {3e4, 0.3, 60});
  object.body.gravity_O = cell.frames.X_WO.linear().transpose() * cell.frames.gravity_W;
  object.surface = mesh::extract_surface(object.body.mesh);
  object.body.damping = {1, 1e-3};
  cell.hand.mass = 1.5;
  cell.hand.first_moment = {0.01, -0.02, 0.15};
  cell.hand.bias = {{0.3, -0.2, 0.5}, {0.01, 0.02, -0.03}};
  return cell;
}

/// Rests at motions of G from rest (m, rotation vector; along and about the axes of O).
inline HeldRecording make_rests(const HeldCell& cell, const std::vector<math::Vector6d>& motions) {
  HeldRecording recording;
  recording.deviation << 0.01, 0.01, 0.01, 5e-4, 5e-4, 5e-4;
  recording.point_deviation = 2e-4;
  const math::Pose& rest = cell.object.body.grasps[0].X_OG_rest;
  for (const math::Vector6d& motion : motions) {
    HeldSample sample;
    sample.time = 2.0 * static_cast<double>(recording.samples.size());
    const math::Pose X_OG = math::make_pose(math::exp_rotation(motion.tail<3>()) * rest.linear(),
                                            rest.translation() + motion.head<3>());
    sample.X_WE = cell.frames.X_WO * X_OG * cell.frames.X_EG.inverse();
    recording.samples.push_back(sample);
  }
  return recording;
}

inline std::vector<math::Vector6d> six_motions() {
  std::vector<math::Vector6d> motions(7, math::Vector6d::Zero());
  motions[1] << 0.008, 0, 0, 0, 0, 0;
  motions[2] << -0.006, 0.02, 0, 0, 0, 0;
  motions[3] << 0, 0, 0.03, 0, -0.3, 0;
  motions[4] << 0, 0, 0, 0.6, 0, 0;
  motions[5] << 0.004, -0.02, 0.01, 0, 0, -0.3;
  motions[6] << 0, 0, -0.02, -0.4, 0.2, 0;
  return motions;
}

/// Initial values of an experiment's parameters.
inline Eigen::VectorXd starts(const Experiment& experiment) { return experiment.start(); }

/// Compares every column of an experiment's Jacobian with differences. `scale`: of parameters that
/// are about zero.
inline void expect_gradient(const Experiment& experiment, const Eigen::VectorXd& at,
                            double scale = 1e-2) {
  const Eigen::VectorXd errors =
      gradient_errors(experiment, at, 2e-4 * at.cwiseAbs().cwiseMax(scale));
  for (Eigen::Index k = 0; k < at.size(); ++k)
    EXPECT_LT(errors[k], 1e-6) << experiment.parameters()[k].name;
}

/// The recording with the readings predicted at `truth`, plus noise of its standard deviation if
/// `seed` > 0.
inline HeldRecording with_readings(HeldRecording recording, const HeldObject& truth,
                                   const Eigen::VectorXd& parameters, int seed) {
  Eigen::VectorXd readings;
  if (!truth.predict(parameters, readings, nullptr)) throw std::runtime_error("no equilibrium");
  math::Random random(static_cast<std::uint64_t>(seed));
  const auto n = static_cast<Eigen::Index>(recording.samples.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    math::Vector6d wrench;
    for (int k = 0; k < 6; ++k)
      wrench[k] = readings[k * n + i] + (seed > 0 ? recording.deviation[k] * random.normal() : 0);
    recording.samples[i].F_S = math::Wrench::from(wrench);
  }
  return recording;
}

}  // namespace palpate::fit
