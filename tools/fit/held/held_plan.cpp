#include "tools/fit/held/held_plan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/common/table.hpp"
#include "tools/fit/held/held_decay.hpp"
#include "tools/fit/held/held_object.hpp"

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using math::kPi;

constexpr char kAxisLetters[] = "xyz";

std::string describe(const math::Vector6d& motion) {
  std::string text;
  for (int k = 0; k < 6; ++k) {
    if (motion[k] == 0) continue;
    text += text.empty() ? "" : ", ";
    text +=
        k < 3 ? common::formatted("%c %+.3g mm", kAxisLetters[k], 1e3 * motion[k])
              : common::formatted("turn %c %+.3g deg", kAxisLetters[k - 3], 180 / kPi * motion[k]);
  }
  return text.empty() ? "hold still" : text;
}

// Of all parameters of a plan: those that may be identified, then the bias, then the grasp's
// offset.
enum { kYoung, kPoisson, kDensity, kMass, kStiffness, kMaterial };
constexpr int kBias = kMaterial, kGrasp = kBias + 6, kCount = kGrasp + 6;
constexpr const char* kNames[kMaterial] = {"young_modulus", "poisson_ratio", "density",
                                           "mass_damping", "stiffness_damping"};
constexpr double kNormal95 = 1.959964;
constexpr double kKnown = 1e-9;   // standard deviation of parameters that are not identified
constexpr double kBinRate = 200;  // Hz, of means during a vibration
constexpr int kModes = 4;
constexpr double kLeastGain = 0.2;  // benefit of a motion: one interval a tenth narrower

using Information = Eigen::Matrix<double, kCount, kCount>;

/// Values, and the unit of each coordinate: 1 of a logarithm, or of the value.
struct Scale {
  std::array<double, kMaterial> values;
  Eigen::Matrix<double, kCount, 1> prior;  // standard deviations

  Scale(const HeldCell& cell, const HeldPlanOptions& options) {
    const elasticity::Body& body = cell.object.body;
    // Damping that is absent in the configuration may still be identified: assume this size.
    const double mass = body.damping.mass_factor, stiffness = body.damping.stiffness_factor;
    values = {body.material.young_modulus, body.material.poisson_ratio, body.material.density,
              mass > 0 ? mass : 1, stiffness > 0 ? stiffness : 1e-3};
    prior.setConstant(std::log(10.0) / kNormal95);
    prior[kPoisson] = 0.5 / kNormal95;
    prior.segment<3>(kBias).setConstant(10);
    prior.segment<3>(kBias + 3).setConstant(1);
    prior.segment<3>(kGrasp).setConstant(options.grasp_position);
    prior.segment<3>(kGrasp + 3).setConstant(options.grasp_angle);
    for (const std::string& name : options.known) {
      const auto found = std::find(std::begin(kNames), std::end(kNames), name);
      if (found == std::end(kNames))
        throw std::invalid_argument("plan: no parameter '" + name + "' can be known");
      prior[found - std::begin(kNames)] = kKnown;
    }
  }
  bool is_logarithmic(int k) const { return k != kPoisson; }
};

Eigen::Matrix3Xd unseen(std::size_t markers) {
  return Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(markers));
}

HeldSample sample_at(const HeldCell& cell, const HandMotion& motion, std::size_t markers) {
  HeldSample sample;
  const math::Pose& rest = cell.object.body.grasps[0].X_OG_rest;
  const math::Vector6d& m = motion.from_rest;
  const auto pose = [&](double share) {
    const math::Pose X_OG = math::make_pose(math::exp_rotation(share * m.tail<3>()) * rest.linear(),
                                            rest.translation() + share * m.head<3>());
    return math::Pose(cell.frames.X_WO * X_OG * cell.frames.X_EG.inverse());
  };
  // From one candidate to the next via the rest pose.
  for (double share = 0; share < 1; share += 0.2) sample.way.push_back(pose(share));
  sample.X_WE = pose(1);
  sample.points_W = unseen(markers);
  return sample;
}

/// Information gained by a motion, or the reason why it is infeasible.
struct Candidate {
  HandMotion motion;
  Information information = Information::Zero();
  std::string refusal;
};

bool is_within(const control::GateLimits& limits, const math::Pose& X_WE) {
  const Eigen::Vector3d p = X_WE.translation();
  return (p.array() >= limits.workspace_lower.array()).all() &&
         (p.array() <= limits.workspace_upper.array()).all();
}

/// A rest: wrench and, if observed, markers.
void look_at_rest(const HeldCell& cell, const control::GateLimits& limits,
                  const HeldPlanOptions& options, const Scale& scale, Candidate& candidate) {
  HeldRecording recording;
  recording.samples = {sample_at(cell, candidate.motion, options.markers.size())};
  if (!is_within(limits, recording.samples[0].X_WE)) {
    candidate.refusal = "leaves the workspace";
    return;
  }
  HeldOptions held;
  held.sought = {true, true, true, true, false};
  held.markers = options.markers;
  VectorXd reading;
  MatrixXd J;
  HeldCell free_hand = cell;  // contribution of the object alone
  free_hand.hand = {};
  try {
    const HeldObject object("plan", free_hand, recording, held);
    if (!object.predict(object.start(), reading, &J)) throw std::invalid_argument("");
  } catch (const std::invalid_argument&) {
    candidate.refusal = "has no stable equilibrium";
    return;
  }
  const double force = reading.head<3>().norm(), torque = reading.segment<3>(3).norm();
  if (force > limits.force || torque > limits.torque) {
    candidate.refusal = "needs more force or torque than the gate allows";
    return;
  }
  const double readings = std::sqrt(options.rate * options.hold);
  MatrixXd rows = MatrixXd::Zero(J.rows(), kCount);
  // Columns of HeldObject: E, nu, density, grasp (6), bias (6).
  rows.col(kYoung) = scale.values[kYoung] * J.col(0);
  rows.col(kPoisson) = J.col(1);
  rows.col(kDensity) = scale.values[kDensity] * J.col(2);
  rows.middleCols<6>(kGrasp) = J.middleCols<6>(3);
  rows.middleCols<6>(kBias) = J.middleCols<6>(9);
  for (int k = 0; k < 6; ++k) {
    const double noise = (k < 3 ? options.force_noise : options.torque_noise) / readings;
    const double error = options.model_error * (k < 3 ? force : torque);
    rows.row(k) *= options.reads_wrench ? 1 / std::hypot(noise, error) : 0;
  }
  if (rows.rows() > 6) rows.bottomRows(rows.rows() - 6) /= options.marker_noise;
  candidate.information = rows.transpose() * rows;
}

/// A vibration: its amplitudes and rest values are unknown and independent of everything else.
void look_at_ringing(const HeldCell& cell, const HeldPlanOptions& options, const Scale& scale,
                     Candidate& candidate) {
  if (!options.reads_wrench) {
    candidate.refusal = "rings unheard";
    return;
  }
  HeldCell believed = cell;
  believed.object.body.damping = {scale.values[kMass], scale.values[kStiffness]};
  HeldRinging ringing;
  ringing.X_WE = sample_at(cell, candidate.motion, 0).X_WE;
  const auto count = static_cast<Eigen::Index>(kBinRate * options.hold);
  ringing.times.setLinSpaced(count, 0, options.hold);
  ringing.readings.setZero(6, count);
  VectorXd reading;
  MatrixXd J;
  int first = 0;
  try {
    const HeldDecay decay("plan", believed, {ringing}, {kModes, true, true, true});
    const VectorXd p = decay.after_stop(decay.start(), 0, candidate.motion.stop);
    if (!decay.predict(p, reading, &J)) throw std::invalid_argument("");
    first = decay.first_parameter(0);
  } catch (const std::invalid_argument&) {
    candidate.refusal = "does not ring with the configuration's object.damping";
    return;
  }
  const double readings = std::sqrt(options.rate / kBinRate);
  for (int k = 0; k < 6; ++k)
    J.middleRows(k * count, count) /=
        (k < 3 ? options.force_noise : options.torque_noise) / readings;
  const MatrixXd own = J.rightCols(J.cols() - first);
  const double scales[] = {scale.values[kYoung], scale.values[kDensity], scale.values[kMass],
                           scale.values[kStiffness]};
  const MatrixXd shared =
      J.leftCols<HeldDecay::kShared>() * Eigen::Map<const Eigen::Vector4d>(scales).asDiagonal();
  MatrixXd normal = own.transpose() * own;
  normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
  const MatrixXd cross = own.transpose() * shared;
  MatrixXd gained = shared.transpose() * shared - cross.transpose() * normal.ldlt().solve(cross);
  // Total information with the model's own error: (measured^-1 + error^2)^-1, where `measured` may
  // be singular.
  const Eigen::Matrix4d error =
      Eigen::Matrix4d::Identity() / (options.model_error * options.model_error);
  gained -= gained * (gained + error).ldlt().solve(gained);
  constexpr int kPlaces[] = {kYoung, kDensity, kMass, kStiffness};
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) candidate.information(kPlaces[a], kPlaces[b]) = gained(a, b);
}

/// Covariance of the material parameters, with all others unknown too.
Eigen::Matrix<double, kMaterial, kMaterial> material_covariance(const Information& information) {
  // Units differ by as much as 1 and 1e-9: inverted after scaling to a diagonal of ones.
  const Eigen::Matrix<double, kCount, 1> size = information.diagonal().cwiseSqrt().cwiseInverse();
  const Information scaled = size.asDiagonal() * information * size.asDiagonal();
  const Information inverse = scaled.ldlt().solve(Information::Identity());
  const Information covariance = size.asDiagonal() * inverse * size.asDiagonal();
  return covariance.topLeftCorner<kMaterial, kMaterial>();
}

std::vector<int> sought(const Scale& scale) {
  std::vector<int> all;
  for (int k = 0; k < kMaterial; ++k)
    if (scale.prior[k] > kKnown) all.push_back(k);
  return all;
}

/// -log of the determinant of the covariance of the parameters to identify.
double merit(const Information& information, const std::vector<int>& places) {
  const auto covariance = material_covariance(information);
  MatrixXd block(places.size(), places.size());
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < places.size(); ++b) block(a, b) = covariance(places[a], places[b]);
  return -block.ldlt().vectorD().array().log().sum();
}

std::vector<Knowledge> knowledge_of(const Information& information, const Scale& scale,
                                    const std::vector<int>& places) {
  const auto covariance = material_covariance(information);
  std::vector<Knowledge> knowledge;
  for (int k : places) {
    const double deviation = std::sqrt(covariance(k, k));
    knowledge.push_back({kNames[k], scale.values[k], deviation, scale.is_logarithmic(k),
                         deviation < 0.5 * scale.prior[k]});
  }
  return knowledge;
}

}  // namespace

std::vector<HandMotion> candidate_motions(const HeldCell& cell, const HeldPlanOptions& options) {
  std::vector<HandMotion> motions;
  const auto add = [&](const math::Vector6d& from_rest) {
    motions.push_back({describe(from_rest), from_rest, math::Vector6d::Zero()});
  };
  add(math::Vector6d::Zero());
  const auto along = [&](int axis, double sign) {
    math::Vector6d motion = math::Vector6d::Zero();
    motion[axis] = sign * (axis < 3 ? options.amplitude : options.turn);
    return motion;
  };
  for (int axis = 0; axis < 6; ++axis)
    for (double sign : {1.0, -1.0}) add(along(axis, sign));
  for (int shift = 0; shift < 3; ++shift)
    for (int turn = 3; turn < 6; ++turn)
      for (double sign : {1.0, -1.0}) add(along(shift, 1) + along(turn, sign));
  if (cell.object.body.fixed_nodes.empty()) {
    for (int axis = 3; axis < 6; ++axis) {
      for (double angle : {0.5 * kPi, -0.5 * kPi, kPi}) {
        math::Vector6d motion = math::Vector6d::Zero();
        motion[axis] = angle;
        add(motion);
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    HandMotion motion;
    motion.stop[axis] = options.speed;
    motion.name = common::formatted("stop from %c %+.3g m/s and let it ring", kAxisLetters[axis],
                                    options.speed);
    motions.push_back(motion);
  }
  return motions;
}

double Knowledge::half() const {
  return is_logarithmic ? value * (factor() - 1) : kNormal95 * deviation;
}
double Knowledge::factor() const { return std::exp(kNormal95 * deviation); }

HeldPlan plan_motions(const HeldCell& cell, const control::GateLimits& limits,
                      const HeldPlanOptions& options) {
  const Scale scale(cell, options);
  const std::vector<int> places = sought(scale);
  if (places.empty()) throw std::invalid_argument("plan: everything is known");
  HeldPlan plan;
  std::vector<Candidate> candidates;
  for (const HandMotion& motion : candidate_motions(cell, options)) {
    ++plan.candidates;
    Candidate candidate;
    candidate.motion = motion;
    if (motion.stop.isZero()) {
      look_at_rest(cell, limits, options, scale, candidate);
    } else {
      look_at_ringing(cell, options, scale, candidate);
    }
    if (candidate.refusal.empty()) {
      candidates.push_back(std::move(candidate));
    } else {
      plan.left_out.push_back(motion.name + ": " + candidate.refusal);
    }
  }
  Information information = scale.prior.cwiseAbs2().cwiseInverse().asDiagonal();
  plan.before = knowledge_of(information, scale, places);
  double now = merit(information, places);
  const auto take = [&](const Candidate& candidate) {
    const double before = now;
    information += candidate.information;
    now = merit(information, places);
    plan.steps.push_back(
        {candidate.motion, now - before, knowledge_of(information, scale, places)});
  };
  // The first sensor reading is the reference for all others.
  if (!candidates.empty() && candidates[0].motion.from_rest.isZero()) take(candidates[0]);
  while (static_cast<int>(plan.steps.size()) < options.steps) {
    const Candidate* best = nullptr;
    double most = kLeastGain;
    for (const Candidate& candidate : candidates) {
      const double gain = merit(information + candidate.information, places) - now;
      if (gain > most) {
        most = gain;
        best = &candidate;
      }
    }
    if (!best) break;
    take(*best);
  }
  for (const Knowledge& known : plan.steps.empty() ? plan.before : plan.steps.back().knowledge)
    if (!known.is_determined) plan.undetermined.push_back(known.name);
  return plan;
}

}  // namespace palpate::fit
