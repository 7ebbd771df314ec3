// Responses of the wrench to what a model may lack, compared with models that have it.
#include "core/estimation/consistency/cause_responses.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "core/elasticity/corotational_model.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;

/// A bent and twisted bar in the hand.
class Held {
 public:
  Held() : body_(support::held_bar({6, 1, 1}, mesh::ElementOrder::kQuadratic)) {
    body_.material = {30e3, 0.3, 60};
    pose_ = body_.grasps[0].X_OG_rest;
    pose_.translation() += Vector3d(0.004, 0.03, -0.05);
    pose_.linear() = math::exp_rotation({0.2, 0.15, 0.1});
    model_ = settle(body_, pose_, body_.gravity_O, {});
    state_.X_OG[0] = pose_;
    state_.motion.update(*model_, state_.filter, state_.X_OG, 1);
    responses_ = std::make_unique<CauseResponses>(body_, mesh::extract_surface(body_.mesh));
    responses_->update(state_, *model_);
  }

  using Loads = std::vector<std::pair<mesh::PointWeights, Vector3d>>;
  static std::unique_ptr<CorotationalQuasistatic> settle(const elasticity::Body& body,
                                                         const math::Pose& pose,
                                                         const Vector3d& gravity,
                                                         const Loads& loads) {
    auto model = std::make_unique<CorotationalQuasistatic>(body);
    model->prepare();
    model->set_gravity(gravity);
    for (int i = 0; i < 200; ++i) {
      math::Pose now = body.grasps[0].X_OG_rest;
      const double share = std::min(1.0, i / 100.0);
      now.translation() += share * (pose.translation() - now.translation());
      now.linear() = math::exp_rotation(share * math::log_rotation(pose.linear()));
      model->hold(0, now);
      model->loads().setZero();
      for (const auto& [point, force] : loads)
        for (int k = 0; k < point.count; ++k)
          model->loads().col(point.nodes[std::size_t(k)]) += point.weights[std::size_t(k)] * force;
      support::refactor(*model);
      model->step(1e-3);
    }
    return model;
  }
  math::Vector6d wrench() const { return model_->reaction(0).vector(); }
  const CauseResponses::Hand& hand() const { return responses_->hand(0); }

  elasticity::Body body_;
  math::Pose pose_;
  FusedState state_{1, {}};
  std::unique_ptr<CorotationalQuasistatic> model_;
  std::unique_ptr<CauseResponses> responses_;
};

/// Within a share of the change; a torque counts as a force at a lever of 0.1 m.
void expect_close(const math::Vector6d& response, const math::Vector6d& change, double share) {
  constexpr double kLever = 0.1;
  math::Vector6d scale;
  scale << Vector3d::Ones(), Vector3d::Constant(1 / kLever);
  EXPECT_LT((response - change).cwiseProduct(scale).norm(),
            share * change.cwiseProduct(scale).norm())
      << response.transpose() << "\n"
      << change.transpose();
}

TEST(CauseResponses, UnevenStiffnessOfEachHalf) {
  Held held;
  for (const int half : {0, 1}) {
    const double step = 0.02;
    elasticity::Body body = held.body_;
    body.element_materials.assign(std::size_t(body.mesh.element_count()), body.material);
    const double middle =
        0.5 * (body.mesh.nodes.row(0).minCoeff() + body.mesh.nodes.row(0).maxCoeff());
    int chosen = 0;
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      double x = 0;
      for (int i = 0; i < 4; ++i) x += body.mesh.nodes(0, body.mesh.elements(i, e)) / 4;
      if ((x > middle) != (half == 1)) continue;
      body.element_materials[std::size_t(e)].young_modulus *= std::exp(step);
      ++chosen;
    }
    ASSERT_GT(chosen, 0);
    const auto changed = Held::settle(body, held.pose_, body.gravity_O, {});
    expect_close(step * held.hand().uneven_stiffness.col(half),
                 changed->reaction(0).vector() - held.wrench(), 0.05);
  }
}

/// The model's own response is that of a factorisation some steps ago, in single precision.
TEST(CauseResponses, HalvesTogetherAreTheResponseToYoungsModulus) {
  Held held;
  const math::Vector6d whole =
      held.model_->sensitivity().dw_dparameter[0].col(elasticity::Sensitivity::kLogYoung);
  expect_close(held.hand().uneven_stiffness.rowwise().sum(), whole, 0.02);
}

TEST(CauseResponses, ForceOnTheSurface) {
  Held held;
  const std::vector<ContactSearch::Place> places = contact_places(
      held.body_, mesh::extract_surface(held.body_.mesh),
      (held.body_.mesh.nodes.rowwise().maxCoeff() - held.body_.mesh.nodes.rowwise().minCoeff())
              .maxCoeff() /
          CauseResponses::kPlaces);
  const Vector3d force(0.002, 0.01, -0.03);
  const auto changed =
      Held::settle(held.body_, held.pose_, held.body_.gravity_O, {{places[0].point, force}});
  expect_close(held.hand().force[0] * force, changed->reaction(0).vector() - held.wrench(), 0.05);
}

/// The object's frame follows the clamp: the hand and gravity move against it.
TEST(CauseResponses, PlaceOfTheClamp) {
  Held held;
  Vector3d clamp = Vector3d::Zero();
  for (const int node : held.body_.fixed_nodes)
    clamp += held.body_.mesh.nodes.col(node) / double(held.body_.fixed_nodes.size());
  for (int axis = 0; axis < 6; ++axis) {
    math::Vector6d motion = math::Vector6d::Zero();
    motion[axis] = axis < 3 ? 3e-4 : 3e-3;
    math::Pose moved = math::Pose::Identity();
    moved.linear() = math::exp_rotation(motion.tail<3>());
    moved.translation() = clamp - moved.linear() * clamp + motion.head<3>();
    const auto changed = Held::settle(held.body_, moved.inverse() * held.pose_,
                                      moved.linear().transpose() * held.body_.gravity_O, {});
    const math::Vector6d wrench = math::both_halves(moved.linear()) * changed->reaction(0).vector();
    expect_close(held.hand().clamp_place * motion, wrench - held.wrench(), 0.06);
  }
}

/// Force and torque on the clamp balance those of hand and weight.
TEST(CauseResponses, ComplianceOfTheClampFollowsItsLoad) {
  Held held;
  Vector3d clamp = Vector3d::Zero();
  for (const int node : held.body_.fixed_nodes)
    clamp += held.body_.mesh.nodes.col(node) / double(held.body_.fixed_nodes.size());
  const Eigen::VectorXd mass = elasticity::ElementSet(held.body_).nodal_mass();
  const math::Vector6d w = held.wrench();
  const Vector3d force = w.head<3>() + mass.sum() * held.body_.gravity_O;
  Vector3d torque = w.tail<3>() + (held.pose_.translation() - clamp).cross(Vector3d(w.head<3>()));
  for (int i = 0; i < mass.size(); ++i)
    torque += (held.model_->positions().col(i) - clamp).cross(mass[i] * held.body_.gravity_O);
  const auto& hand = held.hand();
  EXPECT_LT((hand.clamp_compliance.col(0) - hand.clamp_place.leftCols<3>() * force).norm(),
            1e-6 * hand.clamp_compliance.col(0).norm());
  EXPECT_LT((hand.clamp_compliance.col(1) - hand.clamp_place.rightCols<3>() * torque).norm(),
            1e-6 * hand.clamp_compliance.col(1).norm());
}

}  // namespace
}  // namespace palpate::estimation
