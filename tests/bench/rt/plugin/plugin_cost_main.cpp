// Cost of a plug-in: a control law, an estimator and a deformation model of palpate, called
// directly and through the guards of plug-ins, in pairs of random order. Prints the median of each
// and of the paired difference with its 95 % interval.
//   bench_rt_plugin [PAIRS]

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>

#include "core/control/twist_law.hpp"
#include "core/elasticity/comparison/linear_model.hpp"
#include "core/estimation/pose_driven.hpp"
#include "core/shape/point_features.hpp"
#include "rt/config/command_line.hpp"
#include "rt/plugin/plugin_guards.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"
#include "tools/common/bootstrap.hpp"

namespace palpate {
namespace {

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

double microseconds(const std::function<void()>& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}

void compare(const char* name, int pairs, const std::function<void()>& built_in,
             const std::function<void()>& plugged) {
  std::mt19937 random(1);
  std::vector<double> direct, guarded, difference;
  for (int i = 0; i < pairs; ++i) {
    const bool first = random() % 2 == 0;
    double by_plugin = first ? microseconds(plugged) : 0;
    const double by_built_in = microseconds(built_in);
    if (!first) by_plugin = microseconds(plugged);
    direct.push_back(by_built_in);
    guarded.push_back(by_plugin);
    difference.push_back(by_plugin - by_built_in);
  }
  std::printf("%-10s built in %7.2f us, plug-in %7.2f us, difference %s us\n", name,
              common::median_of(direct).value, common::median_of(guarded).value,
              common::median_and_interval(difference, 3).c_str());
}

void run(int pairs) {
  const elasticity::Body body = support::held_bar({10, 2, 2}, mesh::ElementOrder::kLinear);
  const auto prepared = [](std::unique_ptr<elasticity::DeformationModel> model) {
    model->prepare();
    model->hold(0, model->body().grasps[0].X_OG_rest);
    return model;
  };
  const auto model = prepared(std::make_unique<elasticity::LinearModel>(body));
  const auto plugged_model = prepared(plugin::guard(std::make_unique<Model>(body), "model", body));
  compare(
      "model", pairs, [&] { model->step(1e-3); }, [&] { plugged_model->step(1e-3); });

  estimation::EstimationInputs inputs;
  inputs.grasp_count = 1;
  inputs.grasps[0].pose_freshness = Freshness::kNew;
  inputs.grasps[0].holding = true;
  inputs.grasps[0].X_OG = body.grasps[0].X_OG_rest;
  const auto activated = [&](std::unique_ptr<estimation::Estimator> estimator) {
    estimator->activate(*model);
    return estimator;
  };
  const auto estimator =
      activated(std::make_unique<estimation::PoseDriven>(estimation::PoseDriven::Options{}));
  const auto plugged_estimator =
      activated(plugin::guard(std::make_unique<Estimator>(), "estimator"));
  estimation::Estimate estimate;
  compare(
      "estimator", pairs, [&] { static_cast<void>(estimator->update(inputs, *model, estimate)); },
      [&] { static_cast<void>(plugged_estimator->update(inputs, *model, estimate)); });

  shape::PointFeature feature(body.mesh, {{0.25, 0.03, 0.06}, {0, 1, 2}});
  const Eigen::VectorXd value = Eigen::VectorXd::Zero(3), target = Eigen::VectorXd::Ones(3) * 0.01,
                        error = target;
  const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(3, 6);
  control::LawInputs law_inputs;
  law_inputs.value = &value;
  law_inputs.target = &target;
  law_inputs.error = &error;
  law_inputs.jacobian = &jacobian;
  control::LawOutput output;
  output.unreachable.setZero(3);
  control::ProportionalTwist law{{}};
  law.configure_for(feature);
  const auto plugged_law = plugin::guard(std::make_unique<Law>(), "law");
  plugged_law->configure_for(feature);
  compare(
      "law", pairs, [&] { law.compute(law_inputs, output); },
      [&] { plugged_law->compute(law_inputs, output); });
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  int pairs = 20000;
  CLI::App app("Cost of a plugged-in model, estimator and law compared with the same built in.");
  app.add_option("pairs", pairs, "Number of pairs of calls")->check(CLI::Range(2, 10000000));
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  palpate::run(pairs);
  return 0;
}
