#include <cmath>
#include <stdexcept>

#include "rt/plugin/fence.hpp"
#include "rt/plugin/plugged.hpp"
#include "rt/plugin/plugin_guards.hpp"

namespace palpate::plugin {
namespace {

constexpr char kNotFinite[] = "the plug-in gives numbers that are not finite";

/// Whether all numbers are finite. With several sums side by side, since the matrices of a model
/// are large; Eigen's allFinite() looks at one number after the other.
bool are_finite(const double* numbers, Eigen::Index count) noexcept {
  using Block = Eigen::Array<double, 16, 1>;
  Block sums = Block::Zero(), more = Block::Zero();
  Eigen::Index i = 0;
  for (; i + 32 <= count; i += 32) {
    sums += 0 * Eigen::Map<const Block>(numbers + i);
    more += 0 * Eigen::Map<const Block>(numbers + i + 16);
  }
  double rest = 0;
  for (; i < count; ++i) rest += 0 * numbers[i];
  return (sums + more).sum() + rest == 0;  // 0 times infinity or no number is no number
}

bool is_finite(const estimation::Estimate& estimate) {
  for (int g = 0; g < 2; ++g)
    if (!estimate.X_OG[g].matrix().allFinite() || !estimate.reaction[g].vector().allFinite() ||
        !estimate.bias[g].allFinite() || !estimate.pose_offset[g].allFinite() ||
        !estimate.pose_deviation[g].allFinite() || !estimate.reaction_deviation[g].allFinite() ||
        !estimate.bias_deviation[g].allFinite())
      return false;
  return std::isfinite(estimate.log_young_modulus) && std::isfinite(estimate.poisson_ratio) &&
         estimate.unknown_contact.location_O.allFinite() &&
         estimate.unknown_contact.force_O.allFinite();
}

class GuardedEstimator final : public estimation::Estimator {
 public:
  GuardedEstimator(std::unique_ptr<PluginEstimator> estimator, const std::string& name)
      : estimator_(std::move(estimator), name) {}

  void activate(elasticity::DeformationModel& model) noexcept override {
    // `model` is a component of the same set, which is kept if the call does not return.
    estimator_.call([to = &model](PluginEstimator& made) { made.activate(*to); });
  }

  void take_over(const estimation::Estimate& last,
                 elasticity::DeformationModel& model) noexcept override {
    last_ = last;
    estimator_.call(
        [from = &last_, to = &model](PluginEstimator& made) { made.take_over(*from, *to); });
  }

  UpdateResult update(const estimation::EstimationInputs& inputs,
                      elasticity::DeformationModel& model,
                      estimation::Estimate& estimate) noexcept override {
    estimation::Estimate& own = estimate_.value;
    own = estimate;
    UpdateResult result;
    const bool ended =
        estimator_.call([&](PluginEstimator& made) { result = made.update(inputs, model, own); });
    estimator_.check(estimate_);
    if (!ended || estimator_.why() != nullptr) return {Status::kFault, estimator_.why()};
    if (!is_finite(own) || !model.positions().allFinite()) return {Status::kFault, kNotFinite};
    const auto nodes = static_cast<std::size_t>(model.positions().cols());
    if (result.reason == nullptr ||
        (own.node_deviation != nullptr && own.node_deviation->size() != nodes))
      return {Status::kFault, "the plug-in gives an estimate of another size"};
    estimate = own;
    return result;
  }

  void reset() noexcept override { estimator_.reset(); }

 private:
  Plugged<PluginEstimator> estimator_;
  Fenced<estimation::Estimate> estimate_;
  estimation::Estimate last_;
};

class GuardedDeformationModel final : public elasticity::DeformationModel {
 public:
  GuardedDeformationModel(std::unique_ptr<PluginDeformationModel> model, const std::string& name,
                          const elasticity::Body& body)
      : model_(std::move(model), name), body_(body) {
    const Eigen::Index nodes = body.mesh.nodes.cols();
    new_positions_ = FencedNumbers(3 * nodes);
    new_velocities_ = FencedNumbers(3 * nodes);
    loads_.setZero(3, nodes);
    positions_ = body.mesh.nodes;
    velocities_.setZero(3, nodes);
    none_.resize(static_cast<int>(nodes));
    sensitivity_ = &none_;
  }

  const elasticity::Body& body() const noexcept override { return body_; }

  void prepare() override {
    forget();
    model_.call([](PluginDeformationModel& made) { made.prepare(); });
  }

  void hold(int grasp, const math::Pose& X_OG) noexcept override {
    held_[grasp] = true;
    model_.call([grasp, X_OG](PluginDeformationModel& made) { made.hold(grasp, X_OG); });
  }
  void release(int grasp) noexcept override {
    held_[grasp] = false;
    model_.call([grasp](PluginDeformationModel& made) { made.release(grasp); });
  }
  bool is_held(int grasp) const noexcept override { return held_[grasp]; }

  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override {
    model_.call([gravity_O](PluginDeformationModel& made) { made.set_gravity(gravity_O); });
  }

  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }

  elasticity::StepReport step(double dt) noexcept override {
    if (!agree_) {
      new_positions_.nodes() = positions_;
      new_velocities_.nodes() = velocities_;
    }
    agree_ = false;
    model_.call([this, dt](PluginDeformationModel& made) {
      report_ = made.step(dt, loads_, new_positions_.nodes(), new_velocities_.nodes());
      sensitivity_ = made.sensitivity();
      for (int g = 0; g < 2; ++g) reaction_[g] = held_[g] ? made.reaction(g) : math::Wrench();
    });
    model_.check(new_positions_, new_velocities_);
    if (model_.why() == nullptr) check_result();
    if (model_.why() != nullptr) {
      sensitivity_ = &none_;
      reaction_ = {};
      return {};  // failed; fault() has the reason
    }
    positions_ = new_positions_.nodes();
    velocities_ = new_velocities_.nodes();
    agree_ = true;
    return report_;
  }

  void reset() noexcept override {
    forget();
    model_.reset();
  }

  const Eigen::Matrix3Xd& positions() const noexcept override { return positions_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return velocities_; }
  math::Wrench reaction(int grasp) const noexcept override { return reaction_[grasp]; }
  const elasticity::Sensitivity& sensitivity() const noexcept override { return *sensitivity_; }
  elasticity::Refactorisation* wanted_refactorisation() noexcept override { return nullptr; }
  void install(elasticity::Refactorisation&) noexcept override {}

  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override {
    if (positions.cols() != positions_.cols() || velocities.cols() != velocities_.cols() ||
        !positions.allFinite() || !velocities.allFinite())
      return false;
    positions_ = positions;
    velocities_ = velocities;
    agree_ = false;
    return true;
  }

  const char* fault() const noexcept { return model_.why(); }

 private:
  void forget() noexcept {
    agree_ = false;
    loads_.setZero();
    positions_ = body_.mesh.nodes;
    velocities_.setZero();
    reaction_ = {};
    held_ = {};
    sensitivity_ = &none_;
  }

  /// Faults where positions or what belongs to them are not usable.
  void check_result() noexcept {
    if (!are_finite(new_positions_.data(), new_positions_.size()) ||
        !are_finite(new_velocities_.data(), new_velocities_.size()) ||
        !reaction_[0].vector().allFinite() || !reaction_[1].vector().allFinite())
      model_.fail(kNotFinite);
    if (sensitivity_ == nullptr) sensitivity_ = &none_;
    if (!sensitivity_->valid || sensitivity_ == &none_) return;
    for (int g = 0; g < 2; ++g) {
      if (!held_[g]) continue;
      if (sensitivity_->dx_dxi[g].rows() != loads_.size()) {
        model_.fail("the plug-in gives a sensitivity of another size");
        return;
      }
      if (!are_finite(sensitivity_->dx_dxi[g].data(), sensitivity_->dx_dxi[g].size()) ||
          !sensitivity_->dw_dxi[g][g].allFinite())
        model_.fail(kNotFinite);
    }
  }

  Plugged<PluginDeformationModel> model_;
  const elasticity::Body& body_;
  FencedNumbers new_positions_, new_velocities_;
  bool agree_ = false;  // the new ones with those of the last step
  Eigen::Matrix3Xd loads_, positions_, velocities_;
  std::array<math::Wrench, 2> reaction_{};
  std::array<bool, 2> held_{};
  elasticity::StepReport report_;
  elasticity::Sensitivity none_;
  const elasticity::Sensitivity* sensitivity_ = nullptr;
};

}  // namespace

std::unique_ptr<estimation::Estimator> guard(std::unique_ptr<PluginEstimator> estimator,
                                             const std::string& name) {
  return std::make_unique<GuardedEstimator>(std::move(estimator), name);
}

const char* fault_of(const elasticity::DeformationModel& model) noexcept {
  const auto* guarded = dynamic_cast<const GuardedDeformationModel*>(&model);
  return guarded == nullptr ? nullptr : guarded->fault();
}

std::unique_ptr<elasticity::DeformationModel> guard(std::unique_ptr<PluginDeformationModel> model,
                                                    const std::string& name,
                                                    const elasticity::Body& body) {
  return std::make_unique<GuardedDeformationModel>(std::move(model), name, body);
}

}  // namespace palpate::plugin
