// Components of palpate as a user's plug-ins, for plugin_cost_main.cpp: the control law
// proportional_twist, the estimator pose_driven and the deformation model linear, with their
// defaults.

#include "core/control/twist_law.hpp"
#include "core/elasticity/comparison/linear_model.hpp"
#include "core/estimation/pose_driven.hpp"
#include "rt/plugin/plugin.hpp"

namespace {

using namespace palpate;

struct Options {};

class Law final : public plugin::PluginControlLaw {
 public:
  void configure_for(const shape::Feature& feature) override {
    law_.configure_for(feature);
    output_.unreachable.setZero(feature.dimension());
  }
  void compute(const control::LawInputs& inputs, plugin::PluginLawOutput& output) override {
    law_.compute(inputs, output_);
    output.V_O_G = output_.V_O_G;
    output.unreachable = output_.unreachable;
    output.remark = output_.remark;
  }
  void reset() override { law_.reset(); }

 private:
  control::ProportionalTwist law_{{}};
  control::LawOutput output_;
};

class Estimator final : public plugin::PluginEstimator {
 public:
  void activate(elasticity::DeformationModel& model) override { estimator_.activate(model); }
  UpdateResult update(const estimation::EstimationInputs& inputs,
                      elasticity::DeformationModel& model,
                      estimation::Estimate& estimate) override {
    return estimator_.update(inputs, model, estimate);
  }
  void reset() override { estimator_.reset(); }

 private:
  estimation::PoseDriven estimator_{{}};
};

class Model final : public plugin::PluginDeformationModel {
 public:
  explicit Model(const elasticity::Body& body) : model_(body) {}
  void prepare() override { model_.prepare(); }
  void hold(int grasp, const math::Pose& X_OG) override { model_.hold(grasp, X_OG); }
  void release(int grasp) override { model_.release(grasp); }
  void set_gravity(const Eigen::Vector3d& gravity_O) override { model_.set_gravity(gravity_O); }
  elasticity::StepReport step(double dt, const Eigen::Matrix3Xd& loads, Nodes positions,
                              Nodes velocities) override {
    model_.loads() = loads;
    const elasticity::StepReport report = model_.step(dt);
    positions = model_.positions();
    velocities = model_.velocities();
    return report;
  }
  void reset() override { model_.reset(); }
  math::Wrench reaction(int grasp) const override { return model_.reaction(grasp); }
  const elasticity::Sensitivity* sensitivity() const override { return &model_.sensitivity(); }

 private:
  elasticity::LinearModel model_;
};

}  // namespace

PALPATE_PLUGIN(registrar) {
  const config::OptionTable<Options> none;
  registrar.control_laws.add("twin_law", none, [](const Options&, const plugin::PluginCell&) {
    return std::make_unique<Law>();
  });
  registrar.estimators.add("twin_estimator", none, [](const Options&, const plugin::PluginCell&) {
    return std::make_unique<Estimator>();
  });
  registrar.deformation_models.add("twin_model", none,
                                   [](const Options&, const plugin::PluginCell& cell) {
                                     return std::make_unique<Model>(*cell.body);
                                   });
}
