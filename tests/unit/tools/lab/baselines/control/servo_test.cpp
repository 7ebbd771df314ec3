// Each learning method on its own kind of task: an elastic bar, points to a reachable target,
// observed without error; probes, then the law. And restrictions in the loop.

#include <gtest/gtest.h>

#include <functional>

#include "core/control/twist_law.hpp"
#include "core/shape/point_features.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"
#include "tools/lab/baselines/control/broyden_update.hpp"
#include "tools/lab/baselines/control/factored_update.hpp"
#include "tools/lab/baselines/control/fourier_view.hpp"
#include "tools/lab/baselines/control/gaussian_process.hpp"
#include "tools/lab/baselines/control/gradient_update.hpp"
#include "tools/lab/baselines/control/learning_jacobian.hpp"
#include "tools/lab/baselines/control/two_camera_view.hpp"
#include "tools/lab/baselines/control/weighted_least_squares_update.hpp"

namespace palpate::baselines {
namespace {

using Provider = std::unique_ptr<control::JacobianProvider>;
using Maker = std::function<Provider(const shape::Feature&)>;

constexpr double kDt = 0.05;

Provider learning(const shape::Feature& feature, std::unique_ptr<FeatureView> view,
                  std::unique_ptr<JacobianUpdate> update) {
  return std::make_unique<LearningJacobian>(LearningOptions{}, std::move(view), std::move(update),
                                            feature);
}

struct Method {
  const char* name;
  Maker make;
  double least;  // m, RMS error over the points that must be reached
};

std::vector<Method> methods() {
  const auto plain = [] { return std::make_unique<PlainView>(); };
  return {
      {"broyden",
       [=](const auto& f) { return learning(f, plain(), std::make_unique<BroydenUpdate>(0.5)); },
       2e-4},
      {"gradient",
       [=](const auto& f) {
         return learning(f, plain(), std::make_unique<GradientUpdate>(GradientUpdate::Options{}));
       },
       2e-4},
      {"weighted least squares",
       [=](const auto& f) {
         return learning(
             f, plain(),
             std::make_unique<WeightedLeastSquaresUpdate>(WeightedLeastSquaresUpdate::Options{}));
       },
       2e-4},
      {"fourier",
       [](const auto& f) {
         return learning(f, std::make_unique<FourierView>(FourierView::Options{1, true}),
                         std::make_unique<BroydenUpdate>(0.5));
       },
       2e-4},
      {"two cameras",
       [](const auto& f) {
         return learning(f, std::make_unique<TwoCameraView>(TwoCameraView::Options{}),
                         std::make_unique<GradientUpdate>(GradientUpdate::Options{}));
       },
       2e-4},
      {"factored",
       [](const auto& f) {
         return learning(f, std::make_unique<TwoCameraView>(TwoCameraView::Options{}),
                         std::make_unique<FactoredUpdate>(0.5));
       },
       2e-4},
      {"gaussian process",
       [](const auto& f) -> Provider {
         GaussianProcess::Options options;
         options.dead_band = 1e-4;
         return std::make_unique<GaussianProcess>(options, f);
       },
       1e-3},
  };
}

class Servo : public ::testing::TestWithParam<int> {};

TEST_P(Servo, BringsPointsOfABarToTheirTarget) {
  const Method method = methods()[GetParam()];
  support::HeldBarPlant plant(support::weightless_bar());
  support::RigidModel model(plant.body());
  shape::PointsFeature feature(
      plant.body().mesh,
      {{{0.2, 0, 0.03}, {0.35, 0, 0.03}, {0.35, 0.06, 0.03}, {0.2, 0.06, 0.03}}});
  math::Pose X_goal = plant.X_OG();
  X_goal.translation() += Eigen::Vector3d(-0.01, 0.02, 0.04);
  X_goal.linear() = math::exp_rotation({0, -0.15, 0.1});
  const math::Pose X_start = plant.X_OG();
  plant.place(X_goal);
  const Eigen::VectorXd target = plant.value(feature);
  plant.place(X_start);

  const Provider provider = method.make(feature);
  control::TwistLawOptions law_options;
  law_options.linear_speed = 0.08;
  law_options.dead_band.position = 1e-4;
  control::ProportionalTwist law(law_options);
  law.configure_for(feature);
  control::LawOutput output;
  output.unreachable.setZero(feature.dimension());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(feature.dimension(), 6);
  Eigen::VectorXd value = plant.value(feature), error(feature.dimension());
  const double first = (target - value).norm() / 2;
  ASSERT_GT(first, 0.01);
  double last = first;
  for (int step = 0; step < 260; ++step) {
    value = plant.value(feature);
    feature.error(value, target, error);
    last = error.norm() / 2;
    math::Twist V;
    {
      const loop::NoAllocationScope scope;
      provider->observe(support::seen(plant, value, kDt));
      const bool knows = provider->update(feature, model, plant.X_OG(), J);
      control::LawInputs inputs;
      inputs.dt = kDt;
      inputs.value = &value;
      inputs.target = &target;
      inputs.error = &error;
      inputs.jacobian = &J;
      if (!provider->commands(inputs, V)) {
        EXPECT_TRUE(knows);
        law.compute(inputs, output);
        V = output.V_O_G;
      }
      EXPECT_EQ(scope.count(), 0) << step;
    }
    plant.move(V, kDt);
  }
  EXPECT_LT(last, method.least) << "from " << first;
  RecordProperty("error_mm", std::to_string(1e3 * last));
}

INSTANTIATE_TEST_SUITE_P(Methods, Servo, ::testing::Range(0, 7), [](const auto& method) {
  std::string name = methods()[method.param].name;
  for (char& c : name)
    if (c == ' ') c = '_';
  return name;
});

TEST(GaussianProcess, PredictsAndKeepsWhatIsUnlike) {
  support::HeldBarPlant plant(support::weightless_bar());
  shape::PointsFeature feature(plant.body().mesh, {{{0.2, 0, 0.03}, {0.35, 0.06, 0.03}}});
  GaussianProcess::Options options;
  options.samples = 12;
  options.noise = 0.01;
  options.reach = 3;
  GaussianProcess process(options, feature);
  // A feature that follows the hand immediately: change k of 6 is motion k.
  for (int k = 0; k < 6; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const math::Vector6d motion = sign * 0.01 * math::Vector6d::Unit(k);
      process.add(motion, motion);
    }
  }
  EXPECT_EQ(process.sample_count(), 12);
  const math::Vector6d wish = 0.003 * math::Vector6d(math::Vector6d::Ones()).normalized();
  EXPECT_LT((process.predict(wish) - wish).norm() / wish.norm(), 0.2);
  // A similar one replaces it and leaves the others unchanged.
  for (int i = 0; i < 20; ++i)
    process.add(0.0101 * math::Vector6d::Unit(0), 0.0101 * math::Vector6d::Unit(0));
  EXPECT_EQ(process.sample_count(), 12);
  EXPECT_GT(process.predict(0.003 * math::Vector6d::Unit(4))[4], 0.002);
}

}  // namespace
}  // namespace palpate::baselines
