#pragma once

#include <memory>

#include "core/elasticity/corotational_model.hpp"
#include "core/math/random.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"
#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"
#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::support {

/// A bar in equilibrium observed by a camera from above and from one side, at 30 Hz, held by a hand
/// with known pose and wrench: the inputs of estimators in palpated's slot.
class SeenBar {
 public:
  static constexpr double kTick = 1e-3;  // s

  explicit SeenBar(const elasticity::Body& truth, double noise = 0)
      : model_(truth), random_(7), noise_(noise) {
    model_.prepare();
    model_.set_gravity(truth.gravity_O);
    hand = truth.grasps[0].X_OG_rest;
    rest_ = hand;
    const Eigen::Vector3d upper = truth.mesh.nodes.rowwise().maxCoeff();
    const Eigen::Vector3d lower = truth.mesh.nodes.rowwise().minCoeff();
    const mesh::PointLocator locator(model_.body().mesh);
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 3; ++j) {
        const double s = lower.x() + (i + 0.5) / 40 * (upper.x() - lower.x()), t = 0.25 * (j + 1);
        seen_.push_back(locator.locate({s, lower.y() + t * (upper.y() - lower.y()), upper.z()}));
        seen_.push_back(locator.locate({s, lower.y(), lower.z() + t * (upper.z() - lower.z())}));
      }
  }

  /// Advances the ground truth and provides the observations.
  void tick(estimation::EstimationInputs& inputs) {
    model_.hold(0, hand);
    if (elasticity::Refactorisation* job = model_.wanted_refactorisation()) {
      job->run();
      model_.install(*job);
    }
    model_.step(kTick);
    inputs.dt = kTick;
    inputs.grasp_count = 1;
    estimation::GraspInput& grasp = inputs.grasps[0];
    grasp.pose_freshness = Freshness::kNew;
    grasp.holding = true;
    grasp.X_OG = hand;
    grasp.wrench_valid = true;
    grasp.F_G_O = model_.reaction(0);
    const bool looks = sees && ticks_++ % 33 == 0;
    inputs.observation.freshness = looks ? Freshness::kNew : Freshness::kOld;
    if (!looks) return;
    estimation::ObservationInput::Points& points = inputs.observation.points_O;
    points.resize(3, static_cast<Eigen::Index>(seen_.size()));
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      Eigen::Vector3d p = seen_[i].interpolate(model_.positions());
      for (double& x : p) x += noise_ * random_.normal();
      points.col(static_cast<Eigen::Index>(i)) = p;
    }
  }

  /// Moves the hand from its rest by a fraction of a motion, in O.
  void place(double share, const Eigen::Vector3d& way, const Eigen::Vector3d& turn) {
    hand.translation() = rest_.translation() + share * way;
    hand.linear() = math::exp_rotation(share * turn) * rest_.linear();
  }

  elasticity::CorotationalQuasistatic& model() { return model_; }
  math::Pose hand = math::Pose::Identity();
  bool sees = true;

 private:
  elasticity::CorotationalQuasistatic model_;
  math::Random random_;
  double noise_;
  math::Pose rest_ = math::Pose::Identity();
  std::vector<mesh::PointWeights> seen_;
  int ticks_ = 0;
};

/// An estimator with its model, and the ground truth.
struct Watcher {
  Watcher(const elasticity::Body& truth, double noise,
          std::unique_ptr<elasticity::DeformationModel> its_model, estimation::Estimator& what)
      : world(truth, noise), model(std::move(its_model)), estimator(what) {
    model->prepare();
    estimator.activate(*model);
  }

  /// The hand moves by `way` and `turn` within `moving` s, and then rests up to `seconds`. Returns
  /// allocations of the estimator and its model after the first tick.
  std::int64_t run(double seconds, double moving, const Eigen::Vector3d& way,
                   const Eigen::Vector3d& turn) {
    std::int64_t allocations = 0;
    for (int i = 0; i < static_cast<int>(seconds / SeenBar::kTick); ++i) {
      world.place(std::min(1.0, i * SeenBar::kTick / moving), way, turn);
      world.tick(inputs);
      if (elasticity::Refactorisation* job = model->wanted_refactorisation()) {
        job->run();
        model->install(*job);
      }
      const loop::NoAllocationScope scope;
      last = estimator.update(inputs, *model, estimate);
      if (i > 0) allocations += scope.count();
    }
    return allocations;
  }

  /// Mean and largest distance of the estimate's nodes from their true material points, m.
  std::pair<double, double> error() const {
    const elasticity::DeformationModel& truth = const_cast<SeenBar&>(world).model();
    const mesh::PointLocator locator(truth.body().mesh);
    double sum = 0, largest = 0;
    const Eigen::Matrix3Xd& rest = model->body().mesh.nodes;
    for (int i = 0; i < rest.cols(); ++i) {
      const Eigen::Vector3d p = locator.locate(rest.col(i)).interpolate(truth.positions());
      const double distance = (p - model->positions().col(i)).norm();
      sum += distance / static_cast<double>(rest.cols());
      largest = std::max(largest, distance);
    }
    return {sum, largest};
  }

  SeenBar world;
  std::unique_ptr<elasticity::DeformationModel> model;
  estimation::Estimator& estimator;
  estimation::EstimationInputs inputs;
  estimation::Estimate estimate;
  UpdateResult last;
};

/// Background for separate models.
inline std::unique_ptr<elasticity::DeformationModel> carrier(const elasticity::Body& body) {
  return std::make_unique<baselines::AsRigidAsPossible>(body);
}

}  // namespace palpate::support
