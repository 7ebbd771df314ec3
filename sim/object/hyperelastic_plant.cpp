#include "sim/object/hyperelastic_plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/object/graded_borders.hpp"
#include "sim/object/neo_hookean_solid.hpp"

namespace palpate::object {
namespace {

constexpr double kSafety = 0.9;  // of the critical step
constexpr double kMostRefinement =
    8;  // upper bound of substeps relative to those at rest, regardless of compression
constexpr double kMostContact = 32;       // the same with fingertips or obstacles in contact
constexpr double kUnloadedStrain = 1e-6;  // whose stress represents the load of an unloaded body
constexpr double kContactStiffness = 50;  // of a fingertip, relative to E / radius
constexpr double kShearStiffness = 0.5;   // relative to that
constexpr double kSamplesPerRadius = 6;   // of the surface, along a line

void check(const PlantOptions& options) {
  if (!(options.density > 0)) throw std::invalid_argument("plant: density must be positive");
  if (!(options.mass_damping >= 0)) {
    throw std::invalid_argument("plant: mass_damping must not be negative");
  }
  if (options.substeps < 0) throw std::invalid_argument("plant: substeps must not be negative");
  if (!options.gravity_O.allFinite()) throw std::invalid_argument("plant: gravity must be finite");
  if (options.grasps.size() > PlantOptions::kMostGrasps) {
    throw std::invalid_argument("plant: at most two hands hold it");
  }
  if (options.clamp_pads && !options.clamp) {
    throw std::invalid_argument("plant: pads of the clamp need a clamp");
  }
}

HexahedralGrid::Borders borders(const PlantOptions& options) {
  HexahedralGrid::Borders borders;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> planes;
    const auto add = [&](const Box& hold) {
      for (const double p : planes_of(hold, options.origin, options.size, axis))
        planes.push_back(p);
    };
    if (options.clamp) add(*options.clamp);
    for (const GraspOptions& grasp : options.grasps) add(grasp.patch);
    borders[axis] =
        graded_borders(options.size[axis], options.elements[axis], planes, options.grading);
  }
  return borders;
}

SolidOptions solid_options(const PlantOptions& options) {
  return {NeoHookean::from_young(options.young_modulus, options.poisson_ratio),
          options.viscosity,
          options.maxwell,
          options.yield,
          options.regions,
          options.stiffness_field};
}

}  // namespace

HyperelasticPlant::HyperelasticPlant(const PlantOptions& options)
    : options_((check(options), options)),
      grid_(options.origin, borders(options)),
      solid_(grid_, solid_options(options)),
      masses_(options.density * grid_.nodal_volumes()),
      inverse_masses_(masses_.cwiseInverse().transpose().replicate<3, 1>()),
      weight_(options.gravity_O * masses_.transpose()),
      pad_damping_(Eigen::VectorXd::Zero(grid_.node_count())),
      contact_stiffness_(Eigen::VectorXd::Zero(grid_.node_count())),
      positions_(grid_.nodes()),
      velocities_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())),
      applied_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())),
      driving_(Eigen::Matrix3Xd::Zero(3, grid_.node_count())),
      tip_sums_(6, static_cast<int>(options.fingertips.size())) {
  add_grasps();
  Eigen::VectorXd springs = Eigen::VectorXd::Zero(grid_.node_count());
  for (const CompliantGrasp& grasp : grasps_) grasp.add_stiffness_bound(springs);
  for (int n = 0; n < grid_.node_count(); ++n)
    if (springs[n] > 0) padded_.push_back(n);
  add_fingertips();
  critical_step_ = object::critical_step(grid_, solid_, masses_, springs, fixed_);
  add_obstacles();
  update_forces(0, 0);
}

void HyperelasticPlant::add_grasps() {
  for (const GraspOptions& grasp : options_.grasps) grasps_.emplace_back(grid_, grasp);
  if (options_.clamp) {
    clamped_ = grid_.nodes_in(*options_.clamp);
    if (clamped_.empty()) throw std::invalid_argument("plant: the clamp box holds no node");
    if (options_.clamp_pads) {
      GraspOptions rig;
      rig.patch = *options_.clamp;
      rig.stiffness = options_.clamp_pads->stiffness;
      rig.damping = options_.clamp_pads->damping;
      grasps_.emplace_back(grid_, rig);
    } else {
      fixed_ = clamped_;
    }
  }
  hand_sums_.resize(6, static_cast<int>(grasps_.size()));
}

void HyperelasticPlant::add_fingertips() {
  if (options_.fingertips.empty()) return;
  double smallest = std::numeric_limits<double>::infinity();
  for (const FingertipOptions& tip : options_.fingertips) smallest = std::min(smallest, tip.radius);
  surface_ = ContactSurface(grid_, smallest / kSamplesPerRadius);
  for (FingertipOptions tip : options_.fingertips) {
    if (tip.stiffness == 0) tip.stiffness = kContactStiffness * options_.young_modulus / tip.radius;
    if (tip.shear_stiffness == 0) {
      tip.shear_stiffness = kShearStiffness * tip.stiffness;
    }
    fingertips_.emplace_back(tip, surface_);
  }
}

void HyperelasticPlant::add_obstacles() {
  for (ObstacleOptions obstacle : options_.obstacles) {
    if (obstacle.stiffness == 0) obstacle.stiffness = kObstacleStiffness * options_.young_modulus;
    obstacles_.emplace_back(obstacle, grid_);
    const Eigen::VectorXd greatest = obstacles_.back().greatest_stiffness(positions_);
    const double added =
        0.25 * critical_step_ * critical_step_ * greatest.cwiseQuotient(masses_).maxCoeff();
    const double most = kMostContact * kMostContact - kMostRefinement * kMostRefinement;
    if (added > most) {
      throw std::invalid_argument(
          "plant: the stiffness of an obstacle limits the step too much; "
          "allowed: at most " +
          std::to_string(obstacle.stiffness * most / added) + " Pa/m");
    }
  }
}

double HyperelasticPlant::stable_step() const noexcept {
  double contact = 0;  // bound on the square of the highest frequency that contacts add
  if (!fingertips_.empty() || !obstacles_.empty())
    contact = contact_stiffness_.cwiseQuotient(masses_).maxCoeff();
  // The bounds are the first arguments, so that they are also the result for a NaN.
  const double material = std::min(kMostRefinement, std::sqrt(stiffening_));
  const double added = 0.25 * critical_step_ * critical_step_ * contact;
  const double refinement =
      added > 0 ? std::min(kMostContact, std::sqrt(material * material + added)) : material;
  return kSafety * critical_step_ / refinement;
}

void HyperelasticPlant::update_forces(double h, double h_material) noexcept {
  driving_ = weight_ + applied_;
  for (const int n : padded_) pad_damping_[n] = 0;
  stiffening_ = solid_.add_forces(positions_, velocities_, h_material, driving_);
  for (CompliantGrasp& grasp : grasps_)
    grasp.add_forces(positions_, velocities_, driving_, pad_damping_);
  if (fingertips_.empty() && obstacles_.empty()) return;
  contact_stiffness_.setZero();
  for (FingertipContact& tip : fingertips_)
    tip.add_forces(surface_, positions_, velocities_, h, driving_, contact_stiffness_);
  for (ObstacleContact& obstacle : obstacles_)
    obstacle.add_forces(positions_, velocities_, h, driving_, contact_stiffness_);
}

void HyperelasticPlant::begin_substep(double h) noexcept {
  for (const int n : padded_) driving_.col(n) -= pad_damping_[n] * velocities_.col(n);
  velocities_.array() +=
      0.5 * h *
      (inverse_masses_.array() * driving_.array() - options_.mass_damping * velocities_.array());
  for (const int n : fixed_) velocities_.col(n).setZero();
  positions_ += h * velocities_;
}

void HyperelasticPlant::end_substep(double h, double h_material) noexcept {
  update_forces(h, h_material);
  const double keep = 1 / (1 + 0.5 * h * options_.mass_damping);
  velocities_.array() =
      keep * (velocities_.array() + 0.5 * h * inverse_masses_.array() * driving_.array());
  for (const int n : padded_)
    velocities_.col(n) /= 1 + keep * 0.5 * h * pad_damping_[n] / masses_[n];
  for (const int n : fixed_) velocities_.col(n).setZero();
}

void HyperelasticPlant::add_wrenches(double weight) noexcept {
  for (std::size_t i = 0; i < grasps_.size(); ++i)
    hand_sums_.col(i) += weight * grasps_[i].wrench(positions_, velocities_).vector();
  for (std::size_t i = 0; i < fingertips_.size(); ++i)
    tip_sums_.col(i) += weight * fingertips_[i].wrench().vector();
  for (ObstacleContact& obstacle : obstacles_) obstacle.add_to_mean(weight);
}

void HyperelasticPlant::step(double dt) noexcept {
  const auto substeps_for = [this](double seconds) {
    if (options_.substeps > 0) return options_.substeps;
    return std::max(1, static_cast<int>(std::ceil(seconds / stable_step())));
  };
  hand_sums_.setZero();
  tip_sums_.setZero();
  for (ObstacleContact& obstacle : obstacles_) obstacle.begin_mean();
  for (CompliantGrasp& grasp : grasps_) grasp.begin();
  for (FingertipContact& tip : fingertips_) tip.begin();
  substeps_ = 0;
  int left = substeps_for(dt);
  double h = dt / left;
  double last = 0;
  while (left > 0) {
    add_wrenches(0.5 * (last + h) / dt);
    begin_substep(h);
    --left;
    const double s = 1 - left * h / dt;
    for (CompliantGrasp& grasp : grasps_) grasp.advance(s);
    for (FingertipContact& tip : fingertips_) tip.advance(s);
    end_substep(h, h);
    last = h;
    ++substeps_;
    // If the body stiffens during the step, the rest of it takes shorter substeps.
    if (options_.substeps == 0 && left > 0 && !(stable_step() >= h)) {
      const double rest = left * h;
      left = substeps_for(rest);
      h = rest / left;
    }
  }
  add_wrenches(0.5 * last / dt);
  for (std::size_t i = 0; i < grasps_.size(); ++i) {
    grasps_[i].end();
    grasps_[i].set_mean_wrench(math::Wrench::from(hand_sums_.col(i)));
  }
  for (std::size_t i = 0; i < fingertips_.size(); ++i) {
    fingertips_[i].end();
    fingertips_[i].set_mean_wrench(math::Wrench::from(tip_sums_.col(i)));
  }
}

void HyperelasticPlant::step(double dt, const math::Pose& X_OG, const math::Twist& V_O_G) noexcept {
  if (grasp_count() > 0) move_hand(0, X_OG, V_O_G);
  step(dt);
}

void HyperelasticPlant::move_hand(int hand, const math::Pose& X_OG,
                                  const math::Twist& V_O_G) noexcept {
  grasps_[hand].hand().send(X_OG, V_O_G);
}

void HyperelasticPlant::move_fingertip(int tip, const Eigen::Vector3d& centre,
                                       const math::Twist& velocity) noexcept {
  const bool present = fingertips_[tip].present();
  fingertips_[tip].send(centre, velocity);
  if (!present) update_forces(0, 0);
}

double HyperelasticPlant::load_scale() const noexcept {
  double scale = kUnloadedStrain * options_.young_modulus * options_.size.cwiseAbs2().maxCoeff() +
                 options_.gravity_O.norm() * masses_.sum();
  for (int n = 0; n < grid_.node_count(); ++n) scale += applied_.col(n).norm();
  for (const CompliantGrasp& grasp : grasps_) scale += grasp.force_scale();
  for (const FingertipContact& tip : fingertips_) scale += tip.touch().force.norm();
  for (const ObstacleContact& obstacle : obstacles_) scale += obstacle.touch().wrench.force.norm();
  return scale;
}

double HyperelasticPlant::free_force() const noexcept {
  double squared = driving_.squaredNorm();
  for (const int n : fixed_) squared -= driving_.col(n).squaredNorm();
  return std::sqrt(std::max(0.0, squared));
}

HyperelasticPlant::Settling HyperelasticPlant::settle(double max_seconds,
                                                      double tolerance) noexcept {
  constexpr double kRelaxed = std::numeric_limits<double>::infinity();
  Settling result;
  const auto stop = [&] {
    velocities_.setZero();
    update_forces(0, kRelaxed);
    result.residual = free_force() / load_scale();
    result.converged = result.residual <= tolerance;
  };
  for (CompliantGrasp& grasp : grasps_) grasp.stop();
  for (FingertipContact& tip : fingertips_) tip.stop();
  stop();
  double energy = 0;
  while (!result.converged && result.seconds < max_seconds) {
    const double h = stable_step();
    begin_substep(h);
    end_substep(h, kRelaxed);
    result.seconds += h;
    const double last = energy;
    energy = kinetic_energy();
    if (energy < last) {
      stop();
      energy = 0;
    }
  }
  if (!result.converged) stop();
  for (CompliantGrasp& grasp : grasps_)
    grasp.set_mean_wrench(grasp.wrench(positions_, velocities_));
  for (FingertipContact& tip : fingertips_) tip.set_mean_wrench(tip.wrench());
  for (ObstacleContact& obstacle : obstacles_) {
    obstacle.begin_mean();
    obstacle.add_to_mean(1);
  }
  return result;
}

math::Wrench HyperelasticPlant::clamp_wrench() const noexcept {
  if (options_.clamp_pads) return grasps_.back().wrench(positions_, velocities_);
  math::Wrench total;
  for (const int n : fixed_) {
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

std::vector<std::string> HyperelasticPlant::remarks() const {
  std::vector<std::string> remarks;
  // Pads hold whole faces of elements, a clamp without pads all nodes.
  const auto add = [&](const Box& hold, const std::string& name, bool midnodes) {
    for (const std::string& remark : misfits(hold, options_.origin, grid_.borders(), midnodes))
      remarks.push_back(name + " " + remark);
  };
  if (options_.clamp) add(*options_.clamp, "the clamp", !options_.clamp_pads);
  for (const GraspOptions& grasp : options_.grasps) add(grasp.patch, "a grasp", false);
  return remarks;
}

void HyperelasticPlant::set_state(const Eigen::Matrix3Xd& positions,
                                  const Eigen::Matrix3Xd& velocities) {
  if (positions.cols() != grid_.node_count() || velocities.cols() != grid_.node_count()) {
    throw std::invalid_argument("plant: a state has one column per node");
  }
  positions_ = positions;
  velocities_ = velocities;
  for (const int n : fixed_) velocities_.col(n).setZero();
  update_forces(0, 0);
}

double HyperelasticPlant::kinetic_energy() const noexcept {
  double twice = 0;
  for (int n = 0; n < grid_.node_count(); ++n)
    twice += masses_[n] * velocities_.col(n).squaredNorm();
  return 0.5 * twice;
}

}  // namespace palpate::object
