#include "simulated_arm.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace palpate::driver {
namespace {

constexpr double kFollows = 0.01;  // s, time constant of its drives
constexpr double kRest = 1e-6;     // rad/s, below which its brakes engage
constexpr double kLatest = 0.05;   // s, that it keeps a velocity without a new command

double machine_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

SimulatedArm::SimulatedArm(const kinematics::SerialChain& chain, const Options& options)
    : chain_(chain), options_(options), q_(options.q) {
  dq_.setZero(q_.size());
  wanted_.setZero(q_.size());
  if (!options_.clock) options_.clock = machine_time;
  commanded_at_ = options_.clock();
}

/// An arm moves on while a cycle of the driver is late.
void SimulatedArm::command(const Joints& dq) {
  const double now = options_.clock(), dt = std::min(kLatest, now - commanded_at_);
  commanded_at_ = now;
  q_ += dt * dq_;
  wanted_ = dq;
  if (stopped_) wanted_.setZero();
  dq_ += std::min(1.0, dt / kFollows) * (wanted_ - dq_);
  if (wanted_.isZero(0) && dq_.lpNorm<Eigen::Infinity>() < kRest) dq_.setZero();
}

bool SimulatedArm::read(ArmState& state) {
  state.q = q_;
  state.dq = dq_;
  state.tau.setZero(q_.size());
  state.stopped = stopped_;
  kinematics::SerialChain::State pose;
  chain_.evaluate(q_, pose);
  // It carries the slowly moving hand. A sensor without noise would be treated as frozen.
  const Eigen::Vector3d force =
      pose.X_WE.linear().transpose() * Eigen::Vector3d(0, 0, 9.81 * options_.mass);
  state.wrench_S = {force, options_.center_of_mass.cross(force)};
  for (int i = 0; i < 3; ++i) {
    state.wrench_S.force[i] += 0.02 * noise_(random_);
    state.wrench_S.torque[i] += 1e-3 * noise_(random_);
  }
  return true;
}

}  // namespace palpate::driver
