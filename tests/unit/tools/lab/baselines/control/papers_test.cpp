// Results reported in the papers, as far as they can be reproduced on an elastic bar observed
// without error. Sections are those of the claims, from summaries of the papers.

#include <gtest/gtest.h>

#include "core/control/twist_law.hpp"
#include "core/shape/point_features.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"
#include "tools/lab/baselines/control/constant_jacobian.hpp"
#include "tools/lab/baselines/control/difference_jacobian.hpp"
#include "tools/lab/baselines/control/diminishing_rigidity.hpp"
#include "tools/lab/baselines/control/factored_update.hpp"
#include "tools/lab/baselines/control/learning_jacobian.hpp"
#include "tools/lab/baselines/control/two_camera_view.hpp"
#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

namespace palpate::baselines {
namespace {

constexpr double kPaperDt = 0.05;

class Papers : public ::testing::Test {
 protected:
  Papers() {
    model_.mutable_sensitivity() = plant_.response();
    model_.mutable_sensitivity().valid = true;
    model_.hold(0, plant_.X_OG());
    math::Pose X_goal = plant_.X_OG();
    X_goal.translation() += Eigen::Vector3d(-0.01, 0.03, 0.06);
    X_goal.linear() = math::exp_rotation({0, -0.2, 0.1});
    target_ = value_at(plant_, X_goal);
    law_options_.linear_speed = 0.08;
    law_options_.dead_band.position = 1e-4;
  }
  Eigen::VectorXd value_at(support::HeldBarPlant& plant, const math::Pose& X) {
    const math::Pose before = plant.X_OG();
    plant.place(X);
    const Eigen::VectorXd value = plant.value(feature_);
    plant.place(before);
    return value;
  }
  /// RMS error of the points, m, after this many steps under provider and law.
  double servo(control::JacobianProvider& provider, support::HeldBarPlant& plant, int steps) {
    control::ProportionalTwist law(law_options_);
    law.configure_for(feature_);
    control::LawOutput output;
    output.unreachable.setZero(feature_.dimension());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(feature_.dimension(), 6);
    Eigen::VectorXd error(feature_.dimension());
    for (int step = 0; step < steps; ++step) {
      const Eigen::VectorXd value = plant.value(feature_);
      feature_.error(value, target_, error);
      provider.observe(support::seen(plant, value, kPaperDt));
      provider.update(feature_, model_, plant.X_OG(), J);
      control::LawInputs inputs;
      inputs.dt = kPaperDt;
      inputs.value = &value;
      inputs.target = &target_;
      inputs.error = &error;
      inputs.jacobian = &J;
      math::Twist V;
      if (!provider.commands(inputs, V)) {
        law.compute(inputs, output);
        V = output.V_O_G;
      }
      plant.move(V, kPaperDt);
    }
    return error_of(plant);
  }
  double error_of(support::HeldBarPlant& plant) {
    return (target_ - plant.value(feature_)).norm() / std::sqrt(2.0);
  }

  support::HeldBarPlant plant_{support::weightless_bar()};
  support::RigidModel model_{plant_.body()};
  shape::PointsFeature feature_{plant_.body().mesh, {{{0.25, 0, 0.03}, {0.35, 0.06, 0.03}}}};
  Eigen::VectorXd target_;
  control::TwistLawOptions law_options_;
};

/// Berenson, IROS 2013, experiments: the task succeeds without a model of the object, for any
/// diminishing rate in a wide range; a rate is a choice, not a measurement.
TEST_F(Papers, DiminishingRigidityNeedsNoExactRate) {
  const double first = error_of(plant_);
  ASSERT_GT(first, 0.02);
  const math::Pose X_start = plant_.X_OG();
  for (const double rate : {1.0, 2.0, 4.0, 10.0}) {
    plant_.place(X_start);
    DiminishingRigidity provider({rate, rate, 0}, plant_.body(), 0);
    EXPECT_LT(servo(provider, plant_, 500), 0.05 * first) << rate;
  }
}

/// Aghajanzadeh et al., Frontiers 2022, section on simulations: a single Jacobian computed off line
/// at the rest shape controls the object through a large deformation.
TEST_F(Papers, AConstantJacobianCarriesThroughALargeDeformation) {
  const double first = error_of(plant_);
  ConstantJacobian provider({0}, feature_);
  EXPECT_LT(servo(provider, plant_, 300), 0.02 * first);
}

/// Shetab-Bushehri et al., RA-L 2022, section on results: the same controller brings objects of
/// different stiffness to their targets, since it uses no mechanical parameters.
TEST_F(Papers, AsRigidAsPossibleIsTheSameForEveryStiffness) {
  const double first = error_of(plant_);
  for (const double factor : {0.1, 10.0}) {
    elasticity::Body body = plant_.body();
    body.material.young_modulus *= factor;
    support::HeldBarPlant plant(body);
    DifferenceJacobian provider({}, body, 0, [](const elasticity::Body& copy) {
      return std::make_unique<AsRigidAsPossible>(copy);
    });
    // Here a tick lasts fifty of the loop's, in which the copies keep up with the hand.
    class KeepsUp final : public control::JacobianProvider {
     public:
      explicit KeepsUp(DifferenceJacobian& inner) : inner_(inner) {}
      bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                  const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override {
        for (int i = 0; i < 49; ++i) inner_.update(feature, model, X_OG, J);
        return inner_.update(feature, model, X_OG, J);
      }

     private:
      DifferenceJacobian& inner_;
    } keeps_up(provider);
    EXPECT_LT(servo(keeps_up, plant, 200), 0.05 * first) << factor;
  }
}

/// Alambeigi et al., RA-L 2018, the experiment with a cut: the object's stiffness changes during
/// control, and both of its Jacobians are adapted until the points reach their target.
TEST_F(Papers, TwoJacobiansSurviveACut) {
  const double first = error_of(plant_);
  LearningOptions options;
  options.least_motion = 5e-4;
  LearningJacobian provider(options, std::make_unique<TwoCameraView>(TwoCameraView::Options{}),
                            std::make_unique<FactoredUpdate>(0.5), feature_);
  law_options_.gain = 0.5;
  const double on_the_way = servo(provider, plant_, 110);
  EXPECT_GT(on_the_way, 0.02 * first);
  elasticity::Body cut = plant_.body();
  cut.element_materials.assign(static_cast<std::size_t>(cut.mesh.element_count()), cut.material);
  for (int e = 0; e < cut.mesh.element_count(); ++e) {
    const double x = cut.mesh.nodes(0, cut.mesh.elements.col(e)).mean();
    if (x > 0.08 && x < 0.17)
      cut.element_materials[static_cast<std::size_t>(e)].young_modulus *= 0.05;
  }
  support::HeldBarPlant after(cut);
  after.place(plant_.X_OG());
  EXPECT_GT(std::abs(error_of(after) - on_the_way), 1e-4) << "the cut is felt";
  EXPECT_LT(servo(provider, after, 400), 0.03 * first);
}

}  // namespace
}  // namespace palpate::baselines
