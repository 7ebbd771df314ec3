#include "sim/object/hyperelastic_plant.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr double kSafety = 0.9;        // of the critical step
constexpr double kMostRefinement = 8;  // substeps over those at rest, however squashed the body is
constexpr int kPowerIterations = 150;
constexpr double kUnloadedStrain = 1e-6;  // whose stress stands for the load of an unloaded body

/// How much shorter steps must be than at rest where the stiffness is `stiffening` times as great.
double refinement(double stiffening) {
  // The bound comes first, so that it is also what a NaN gives.
  return std::min(kMostRefinement, std::sqrt(stiffening));
}

/// Greatest eigenvalue of M^-1 A by power iteration. `apply(direction, out)` writes A direction;
/// rows of held nodes must come out as zero.
template <class Operator>
double greatest_eigenvalue(const Eigen::VectorXd& masses, const Operator& apply) {
  std::minstd_rand generator(1);
  Eigen::Matrix3Xd direction(3, masses.size());
  for (double& value : direction.reshaped()) {
    value = static_cast<double>(generator()) / std::minstd_rand::max() - 0.5;
  }
  Eigen::Matrix3Xd image(3, masses.size());
  double eigenvalue = 0;
  for (int i = 0; i < kPowerIterations; ++i) {
    direction /= direction.norm();
    apply(direction, image);
    image.array().rowwise() /= masses.transpose().array();
    eigenvalue = image.norm();
    if (!(eigenvalue > 0)) return 0;
    direction = image;
  }
  return eigenvalue;
}

void check(const PlantOptions& options) {
  if (!(options.density > 0)) throw std::invalid_argument("plant: density must be positive");
  if (!(options.mass_damping >= 0)) {
    throw std::invalid_argument("plant: mass_damping must not be negative");
  }
  if (options.substeps < 0) throw std::invalid_argument("plant: substeps must not be negative");
  if (!options.gravity_O.allFinite() || !options.X_OG_rest.matrix().allFinite()) {
    throw std::invalid_argument("plant: gravity and rest pose of the hand must be finite");
  }
}

}  // namespace

HyperelasticPlant::HyperelasticPlant(const PlantOptions& options)
    : options_((check(options), options)),
      grid_(options.origin, options.size, options.elements),
      solid_(grid_, NeoHookean::from_young(options.young_modulus, options.poisson_ratio),
             options.viscosity),
      masses_(options.density * grid_.nodal_volumes()),
      damping_(options.mass_damping * masses_),
      X_OG_(options.X_OG_rest),
      positions_(grid_.nodes()),
      velocities_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())),
      applied_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())),
      driving_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())) {
  if (options.clamp) {
    clamped_ = grid_.nodes_in(*options.clamp);
    if (clamped_.empty()) throw std::invalid_argument("plant: the clamp box holds no node");
  }
  if (options.grasp) {
    grasp_ = CompliantGrasp(grid_, *options.grasp, options.pad_stiffness, options.pad_damping);
    set_grasped(true);
  }
  critical_step_ = find_critical_step();
  update_forces();
}

double HyperelasticPlant::find_critical_step() const {
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, grid_.node_count());
  const double tiny = 1e-6 * grid_.element_size().minCoeff();
  Eigen::Matrix3Xd moved(3, grid_.node_count());
  Eigen::Matrix3Xd back(3, grid_.node_count());
  const double stiffest = greatest_eigenvalue(masses_, [&](const auto& direction, auto& out) {
    out.setZero();
    back.setZero();
    moved = grid_.nodes() - tiny * direction;
    hold_clamped(moved, grid_.nodes());
    solid_.add_forces(moved, still, out);
    moved = grid_.nodes() + tiny * direction;
    hold_clamped(moved, grid_.nodes());
    solid_.add_forces(moved, still, back);
    out = (out - back) / (2 * tiny);
    for (const auto& pad : grasp_.pads()) {
      out.col(pad.node) += pad.stiffness * direction.col(pad.node);
    }
    hold_clamped(out, still);
  });
  const double frequency = std::sqrt(stiffest);
  if (solid_.viscosity() == 0) return 2 / frequency;

  const double damping = greatest_eigenvalue(masses_, [&](const auto& direction, auto& out) {
    out.setZero();
    moved = -direction;
    hold_clamped(moved, still);
    solid_.add_forces(grid_.nodes(), moved, out);
    hold_clamped(out, still);
  });
  // Belytschko, Liu, Moran: Nonlinear Finite Elements, sec. 6.2: lagged damping of ratio xi.
  const double xi = damping / (2 * frequency);
  return 2 / frequency * (std::sqrt(xi * xi + 1) - xi);
}

int HyperelasticPlant::stable_substeps(double dt) const noexcept {
  if (options_.substeps > 0) return options_.substeps;
  const double at_rest = dt / (kSafety * critical_step_);
  return std::max(1, static_cast<int>(std::ceil(at_rest * refinement(stiffening_))));
}

void HyperelasticPlant::hold_clamped(Eigen::Matrix3Xd& values,
                                     const Eigen::Matrix3Xd& held) const noexcept {
  for (const int n : clamped_) values.col(n) = held.col(n);
}

void HyperelasticPlant::update_forces() noexcept {
  driving_.noalias() = options_.gravity_O * masses_.transpose();
  driving_ += applied_;
  stiffening_ = solid_.add_forces(positions_, velocities_, driving_);
  if (!grasped_) return;
  for (const auto& pad : grasp_.pads()) {
    driving_.col(pad.node) +=
        pad.stiffness * (pad.p_O - positions_.col(pad.node)) + pad.damping * pad.velocity_O;
  }
}

void HyperelasticPlant::begin_substep(double h) noexcept {
  for (int n = 0; n < grid_.node_count(); ++n) {
    velocities_.col(n) +=
        0.5 * h / masses_[n] * (driving_.col(n) - damping_[n] * velocities_.col(n));
  }
  for (const int n : clamped_) velocities_.col(n).setZero();
  positions_ += h * velocities_;
}

void HyperelasticPlant::end_substep(double h) noexcept {
  update_forces();
  for (int n = 0; n < grid_.node_count(); ++n) {
    const double share = 0.5 * h / masses_[n];
    velocities_.col(n) = (velocities_.col(n) + share * driving_.col(n)) / (1 + share * damping_[n]);
  }
  for (const int n : clamped_) velocities_.col(n).setZero();
}

void HyperelasticPlant::step(double dt, const math::Pose& X_OG, const math::Twist& V_O_G) noexcept {
  const math::Pose X_start = X_OG_;
  const math::Twist V_start = V_O_G_;
  const Eigen::Quaterniond q_start(X_start.linear());
  const Eigen::Quaterniond q_end(X_OG.linear());
  substeps_ = stable_substeps(dt);
  const double h = dt / substeps_;

  math::Vector6d sum = math::Vector6d::Zero();
  if (grasped_) sum = 0.5 * grasp_.wrench(positions_, velocities_).vector();
  for (int i = 1; i <= substeps_; ++i) {
    const double s = static_cast<double>(i) / substeps_;
    X_OG_.translation() = (1 - s) * X_start.translation() + s * X_OG.translation();
    X_OG_.linear() = q_start.slerp(s, q_end).toRotationMatrix();
    V_O_G_.linear = (1 - s) * V_start.linear + s * V_O_G.linear;
    V_O_G_.angular = (1 - s) * V_start.angular + s * V_O_G.angular;
    begin_substep(h);
    if (grasped_) grasp_.move(X_OG_, V_O_G_);
    end_substep(h);
    if (grasped_) {
      sum += (i < substeps_ ? 1.0 : 0.5) * grasp_.wrench(positions_, velocities_).vector();
    }
  }
  hand_wrench_ = math::Wrench::from(sum / substeps_);
}

double HyperelasticPlant::load_scale() const noexcept {
  double scale = kUnloadedStrain * options_.young_modulus * options_.size.cwiseAbs2().maxCoeff() +
                 options_.gravity_O.norm() * masses_.sum();
  for (int n = 0; n < grid_.node_count(); ++n) scale += applied_.col(n).norm();
  if (grasped_) {
    for (const auto& pad : grasp_.pads()) {
      scale += pad.stiffness * (pad.p_O - positions_.col(pad.node)).norm();
    }
  }
  return scale;
}

double HyperelasticPlant::free_force() const noexcept {
  double squared = driving_.squaredNorm();
  for (const int n : clamped_) squared -= driving_.col(n).squaredNorm();
  return std::sqrt(std::max(0.0, squared));
}

HyperelasticPlant::Settling HyperelasticPlant::settle(double max_seconds,
                                                      double tolerance) noexcept {
  Settling result;
  const auto stop = [&] {
    velocities_.setZero();
    update_forces();
    result.residual = free_force() / load_scale();
    result.converged = result.residual <= tolerance;
  };
  V_O_G_ = math::Twist();
  grasp_.move(X_OG_, V_O_G_);
  stop();
  double energy = 0;
  while (!result.converged && result.seconds < max_seconds) {
    const double h = kSafety * critical_step_ / refinement(stiffening_);
    begin_substep(h);
    end_substep(h);
    result.seconds += h;
    const double last = energy;
    energy = kinetic_energy();
    if (energy < last) {
      stop();
      energy = 0;
    }
  }
  if (!result.converged) stop();
  if (grasped_) hand_wrench_ = grasp_.wrench(positions_, velocities_);
  return result;
}

void HyperelasticPlant::set_grasped(bool grasped) noexcept {
  if (grasped == grasped_ || (grasped && grasp_.pads().empty())) return;
  grasped_ = grasped;
  if (grasped) {
    grasp_.attach(X_OG_, positions_);
    grasp_.move(X_OG_, V_O_G_);
  }
  for (const auto& pad : grasp_.pads()) damping_[pad.node] += (grasped ? 1 : -1) * pad.damping;
  hand_wrench_ = math::Wrench();
  update_forces();
}

math::Wrench HyperelasticPlant::clamp_wrench() const noexcept {
  math::Wrench total;
  for (const int n : clamped_) {
    total.force -= driving_.col(n);
    total.torque -= positions_.col(n).cross(driving_.col(n));
  }
  return total;
}

void HyperelasticPlant::add_force(const MaterialPoint& point,
                                  const Eigen::Vector3d& force_O) noexcept {
  for (int a = 0; a < 27; ++a) {
    applied_.col(point.nodes[a]) += point.weights[a] * force_O;
    driving_.col(point.nodes[a]) += point.weights[a] * force_O;
  }
}

void HyperelasticPlant::clear_forces() noexcept {
  driving_ -= applied_;
  applied_.setZero();
}

void HyperelasticPlant::set_state(const Eigen::Matrix3Xd& positions,
                                  const Eigen::Matrix3Xd& velocities) {
  if (positions.cols() != grid_.node_count() || velocities.cols() != grid_.node_count()) {
    throw std::invalid_argument("plant: a state has one column per node");
  }
  positions_ = positions;
  velocities_ = velocities;
  for (const int n : clamped_) velocities_.col(n).setZero();
  update_forces();
}

double HyperelasticPlant::kinetic_energy() const noexcept {
  double twice = 0;
  for (int n = 0; n < grid_.node_count(); ++n)
    twice += masses_[n] * velocities_.col(n).squaredNorm();
  return 0.5 * twice;
}

Eigen::Vector3d HyperelasticPlant::linear_momentum() const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int n = 0; n < grid_.node_count(); ++n) sum += masses_[n] * velocities_.col(n);
  return sum;
}

Eigen::Vector3d HyperelasticPlant::angular_momentum() const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int n = 0; n < grid_.node_count(); ++n) {
    sum += masses_[n] * positions_.col(n).cross(velocities_.col(n));
  }
  return sum;
}

}  // namespace palpate::object
