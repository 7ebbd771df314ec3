#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/math/random.hpp"

namespace palpate::bench {

/// Bar fixed at x = 0, with a grasp of its tip and one of a patch on its upper side.
elasticity::Body make_handled_bar(const mesh::ElementMesh& mesh, double young_modulus);

/// Random handling: grasps held, moved at up to 0.3 m/s and 3 rad/s and released, loads on patches
/// from zero to `most_load` times 1 N at E = 1e5 Pa, in proportion to E.
class RandomHandling {
 public:
  RandomHandling(const elasticity::Body& body, double most_load, math::Random random);

  /// Before each step of dt.
  void apply(double dt, elasticity::DeformationModel& model);
  /// Releases and unloads.
  void let_go(elasticity::DeformationModel& model);

  /// Steps since a grasp was last taken or released.
  long since_change() const { return since_change_; }

 private:
  struct Hand {
    bool is_holding = false;
    long left = 0;  // steps until the next random action
    math::Pose X_OG = math::Pose::Identity(), goal = math::Pose::Identity();
    double linear_speed = 0, angular_speed = 0;
  };
  void reconsider(int grasp, elasticity::DeformationModel& model);
  void load(elasticity::DeformationModel& model);
  Eigen::Vector3d direction();

  const elasticity::Body& body_;
  double most_load_;
  math::Random random_;
  std::vector<Hand> hands_;
  long load_left_ = 0;
  long since_change_ = 0;
};

}  // namespace palpate::bench
