#include "tests/bench/core/elasticity/random_handling.hpp"

#include <algorithm>
#include <cmath>

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::bench {

using Eigen::Vector3d;

elasticity::Body make_handled_bar(const mesh::ElementMesh& mesh, double young_modulus) {
  elasticity::Body body;
  body.mesh = mesh;
  body.material = {young_modulus, 0.35, 300};
  // About critical for the first bending mode, so that it comes to rest as soon as it can.
  const double length = mesh.nodes.row(0).maxCoeff(), height = mesh.nodes.row(2).maxCoeff();
  const double wave_speed = std::sqrt(young_modulus / body.material.density);
  body.damping = {2 * 1.015 * height / (length * length) * wave_speed, 0};
  body.fixed_nodes = elasticity::nodes_at(mesh, 0, 0);
  elasticity::GraspRegion tip, side;
  tip.nodes = elasticity::nodes_at(mesh, 0, length);
  tip.X_OG_rest.translation() = Vector3d(length, height / 2, height / 2);
  side.nodes = mesh::nodes_in_box(mesh, {0.4 * length, 0, height}, {0.65 * length, height, height});
  side.X_OG_rest.translation() = Vector3d(length / 2, height / 2, height);
  body.grasps = {tip, side};
  return body;
}

RandomHandling::RandomHandling(const elasticity::Body& body, double most_load, math::Random random)
    : body_(body), most_load_(most_load), random_(random), hands_(body.grasps.size()) {}

Vector3d RandomHandling::direction() {
  const Vector3d v(random_.normal(), random_.normal(), random_.normal());
  return v / std::max(v.norm(), 1e-9);
}

void RandomHandling::reconsider(int grasp, elasticity::DeformationModel& model) {
  Hand& hand = hands_[grasp];
  hand.left = 50 + static_cast<long>(random_.below(400));
  const bool holds = random_.uniform() < 0.6;
  if (holds != hand.is_holding) since_change_ = 0;
  if (holds && !hand.is_holding) {
    hand.X_OG = elasticity::grasp_pose(body_, grasp, model.positions());
  }
  if (!holds && hand.is_holding) model.release(grasp);
  hand.is_holding = holds;
  hand.goal = body_.grasps[grasp].X_OG_rest;
  hand.goal.translation() += random_.uniform(0, 0.08) * direction();
  hand.goal.linear() = math::exp_rotation(random_.uniform(0, 1) * direction());
  hand.linear_speed = random_.uniform(0, 0.3);
  hand.angular_speed = random_.uniform(0, 3);
}

void RandomHandling::load(elasticity::DeformationModel& model) {
  load_left_ = 20 + static_cast<long>(random_.below(200));
  model.loads().setZero();
  const double sensible = body_.material.young_modulus / 1e5;  // N
  const int patches = static_cast<int>(random_.below(3));      // often none
  for (int k = 0; k < patches; ++k) {
    const Vector3d centre =
        body_.mesh.nodes.col(static_cast<int>(random_.below(body_.mesh.nodes.cols())));
    const double size = sensible * most_load_ * std::pow(10, -4 * random_.uniform());
    const Vector3d force = size * direction();
    const Eigen::Array<bool, 1, Eigen::Dynamic> near =
        (body_.mesh.nodes.colwise() - centre).colwise().norm().array() < 0.02;
    for (int i = 0; i < near.size(); ++i) {
      if (near(i)) model.loads().col(i) += force / static_cast<double>(near.count());
    }
  }
}

void RandomHandling::apply(double dt, elasticity::DeformationModel& model) {
  ++since_change_;
  for (int g = 0; g < static_cast<int>(hands_.size()); ++g) {
    Hand& hand = hands_[g];
    if (--hand.left < 0) reconsider(g, model);
    if (!hand.is_holding) continue;
    const Vector3d way = hand.goal.translation() - hand.X_OG.translation();
    const Vector3d turn = math::log_rotation(hand.goal.linear() * hand.X_OG.linear().transpose());
    const auto bounded = [](const Vector3d& v, double most) -> Vector3d {
      return v * std::min(1.0, most / std::max(v.norm(), 1e-12));
    };
    hand.X_OG.translation() += bounded(way, hand.linear_speed * dt);
    hand.X_OG.linear() =
        math::exp_rotation(bounded(turn, hand.angular_speed * dt)) * hand.X_OG.linear();
    model.hold(g, hand.X_OG);
  }
  if (--load_left_ < 0) load(model);
}

void RandomHandling::let_go(elasticity::DeformationModel& model) {
  for (int g = 0; g < static_cast<int>(hands_.size()); ++g) model.release(g);
  model.loads().setZero();
  model.set_gravity(Vector3d::Zero());
}

}  // namespace palpate::bench
