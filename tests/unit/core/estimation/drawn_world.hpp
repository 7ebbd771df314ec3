#pragma once

#include <memory>
#include <optional>
#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {

/// What good set-up leaves.
inline WrenchFilter::Options calibrated() {
  WrenchFilter::Options priors;
  priors.position = 1.5e-3;
  priors.rotation = 3.5e-3;
  priors.log_young = 0.2;
  priors.bias_force = 0.02;
  priors.bias_torque = 0.002;
  return priors;
}

/// A world of the co-rotational model whose parameters are drawn from the priors, truncated at two
/// deviations, its hand and sensors, and the filter, which knows the nominal bar.
class DrawnWorld {
 public:
  /// `stiffer`: factor of the stiffness of the half at the hand.
  explicit DrawnWorld(std::uint64_t seed, double stiffer = 1)
      : random_(seed), nominal_(support::held_bar({6, 1, 1}, mesh::ElementOrder::kQuadratic)) {
    nominal_.material = {30e3, 0.3, 26};
    const WrenchFilter::Options priors = calibrated();
    elasticity::Body body = nominal_;
    body.material.young_modulus *= std::exp(priors.log_young * draw());
    body.material.poisson_ratio += 0.05 * draw();
    body.material.density *= 1 + 0.03 * draw();
    for (int i = 0; i < 3; ++i) {
      offset_.translation()[i] = priors.position * draw();
      bias_[i] = priors.bias_force * draw();
      bias_[i + 3] = priors.bias_torque * draw();
    }
    offset_.linear() =
        math::exp_rotation(priors.rotation * Eigen::Vector3d(draw(), draw(), draw()));
    if (stiffer != 1) {
      body.element_materials.assign(static_cast<std::size_t>(body.mesh.element_count()),
                                    body.material);
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        double x = 0;
        for (int i = 0; i < 4; ++i) x += body.mesh.nodes(0, body.mesh.elements(i, e)) / 4;
        if (x > 0.25) body.element_materials[std::size_t(e)].young_modulus *= stiffer;
      }
    }
    world_ = std::make_unique<elasticity::CorotationalQuasistatic>(body);
    model_ = std::make_unique<elasticity::CorotationalQuasistatic>(nominal_);
    world_->prepare();
    model_->prepare();
    world_->set_gravity(nominal_.gravity_O);
    PoseWrenchFilter::Options options;
    options.filter = priors;
    options.consistency.enabled = true;
    options.payload_error = 0;
    filter_ =
        std::make_unique<PoseWrenchFilter>(nominal_, mesh::extract_surface(nominal_.mesh), options);
    filter_->activate(*model_);
    inputs_.grasp_count = 1;
    hand_ = nominal_.grasps[0].X_OG_rest;
    from_ = to_ = hand_;
  }

  /// Advances by 1 ms. The hand moves from pose to pose, each drawn at random, two seconds each.
  void tick() {
    constexpr int kMove = 2000;
    if (ticks_ % kMove == 0) {
      from_ = to_;
      to_ = nominal_.grasps[0].X_OG_rest;
      to_.translation() += 0.05 * Eigen::Vector3d(0.1 * uniform(), uniform(), uniform());
      to_.linear() = math::exp_rotation(0.3 * Eigen::Vector3d(uniform(), uniform(), uniform()));
    }
    if (is_moving_) {
      const double share = 0.5 - 0.5 * std::cos(M_PI * (ticks_ % kMove) / kMove);
      hand_.translation() = from_.translation() + share * (to_.translation() - from_.translation());
      hand_.linear() = math::exp_rotation(
                           share * math::log_rotation(to_.linear() * from_.linear().transpose())) *
                       from_.linear();
    }
    ++ticks_;
    world_->hold(0, clamp_.inverse() * hand_ * offset_);
    world_->loads().setZero();
    for (const int node : loaded_) world_->loads().col(node) = load_ / loaded_.size();
    support::refactor(*world_);
    world_->step(1e-3);
    math::Vector6d wrench = world_->reaction(0).vector();
    if (ticks_ == 1) lagged_ = wrench;
    lagged_ += (1 - std::exp(-0.1)) * (wrench - lagged_);
    wrench = lagged_ + math::both_halves((hand_ * offset_).linear()) * bias_;
    for (int i = 0; i < 6; ++i) wrench[i] += (i < 3 ? 0.025 : 0.001) * normal_(random_);
    if (saturated_) wrench[*saturated_] = 660;  // N, full scale of a sensor
    inputs_.grasps[0] = {pose_freshness_, true, hand_, true, math::Wrench::from(wrench)};
    if (ticks_ % period_ != 0) return;
    inputs_.dt = 1e-3 * period_;
    support::refactor(*model_);
    const loop::NoAllocationScope scope;
    result_ = filter_->update(inputs_, *model_, estimate_);
    allocations_ += scope.count();
  }
  /// The first time, s from now, at which the filter reports a contradiction; negative: never.
  double first_report(double seconds) {
    for (int i = 0; i < std::lround(1e3 * seconds); ++i) {
      tick();
      if (is_reported()) return 1e-3 * i;
    }
    return -1;
  }
  void run(double seconds) {
    for (int i = 0; i < std::lround(1e3 * seconds); ++i) tick();
  }
  bool is_reported() const { return filter_->consistency().is_inconsistent(); }
  /// The middle of the upper side is loaded with a force, N.
  void load(const Eigen::Vector3d& force) {
    load_ = force;
    loaded_.clear();
    for (int i = 0; i < nominal_.mesh.node_count(); ++i)
      if (std::abs(nominal_.mesh.nodes(0, i) - 0.25) < 1e-6 && nominal_.mesh.nodes(2, i) > 0.059)
        loaded_.push_back(i);
  }
  /// From now on the hand holds the object elsewhere, by a motion in G.
  void slip(const math::Pose& motion) { offset_ = offset_ * motion; }
  void add_bias(const math::Vector6d& bias) { bias_ += bias; }
  /// The object is displaced in the world, without gravity.
  void move_clamp(const Eigen::Vector3d& by) { clamp_.translation() = by; }
  double mean_error() const {
    return (model_->positions() - world_->positions()).colwise().norm().mean();
  }

  bool is_moving_ = true;
  std::optional<int> saturated_;  // component of the measured wrench that is at full scale
  Freshness pose_freshness_ = Freshness::kNew;
  int period_ = 1;  // ms, of the filter's updates
  Estimate estimate_;
  UpdateResult result_;
  std::int64_t allocations_ = 0;  // of the filter's updates
  const PoseWrenchFilter& filter() const { return *filter_; }
  const std::vector<float>& deviations() const { return *estimate_.node_deviation; }
  double share_within_ball() const {
    int within = 0;
    for (int i = 0; i < nominal_.mesh.node_count(); ++i) {
      const double error = (model_->positions().col(i) - world_->positions().col(i)).norm();
      // 95 % of an isotropic normal distribution in three dimensions.
      within += error <= 2.795 * std::max(1e-9, double(deviations()[std::size_t(i)])) ? 1 : 0;
    }
    return double(within) / nominal_.mesh.node_count();
  }

 private:
  double draw() {
    for (;;) {
      const double z = normal_(random_);
      if (std::abs(z) <= 2) return z;
    }
  }
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  elasticity::Body nominal_;
  std::unique_ptr<elasticity::CorotationalQuasistatic> world_, model_;
  std::unique_ptr<PoseWrenchFilter> filter_;
  math::Pose offset_ = math::Pose::Identity(), clamp_ = math::Pose::Identity(), hand_, from_, to_;
  math::Vector6d bias_ = math::Vector6d::Zero(), lagged_ = math::Vector6d::Zero();
  std::vector<int> loaded_;
  Eigen::Vector3d load_ = Eigen::Vector3d::Zero();
  EstimationInputs inputs_;
  int ticks_ = 0;
};

}  // namespace palpate::estimation
