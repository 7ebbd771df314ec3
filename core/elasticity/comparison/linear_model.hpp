#pragma once

#include "core/elasticity/comparison/comparison_model.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/factor/supernodal_factor.hpp"

namespace palpate::elasticity {

/// Small-displacement statics, K u = loads + weight, with one factor of the constant K for every
/// set of held grasps, computed by prepare(). Linear and quadratic tetrahedra, Young's modulus per
/// element. Grasped nodes follow the hand exactly, but the rest of the body responds linearly:
/// rotation causes spurious expansion, so that shape and force are valid for small rotations only.
///
/// The lever arms of the reaction are those of the moved patch, which makes the wrench the
/// derivative of the model's energy with respect to the hand's motion. The sensitivity is exact and
/// of age zero after every step; dw_dxi assumes constant loads. step() fails if the body is not
/// supported.
class LinearModel final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body or an element without positive volume.
  explicit LinearModel(Body body);

  void prepare() override;
  void release(int grasp) noexcept override;
  void reset() noexcept override;
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

 private:
  // Response of the body to the twelve parameters of an affine motion of one patch, A r + t:
  // columns t (3), then A column by column (9); r from the origin of G at rest.
  using Affine = Eigen::Matrix<double, Eigen::Dynamic, 12>;
  struct Response {
    std::array<Affine, 2> shape;                 // [g]: displacements per motion of g, 3 n rows
    std::array<std::array<Affine, 2>, 2> force;  // [a][g]: forces on patch a, 3 rows per node
  };

  StepReport advance(double dt) noexcept override;
  factor::Held held() const noexcept { return {held_.is_held(0), held_.is_held(1)}; }
  void solve(factor::Held held) noexcept;
  void respond(factor::Held held, int grasp, Response& response);
  void update_sensitivity(const Response& response) noexcept;

  ElementSet elements_;
  factor::BlockPattern pattern_;
  factor::Supernodes supernodes_;
  factor::BlockMatrix stiffness_;
  factor::SupernodalFactor factor_;
  bool prepared_ = false;
  std::array<Response, 4> responses_;  // indexed by HeldNodes::held_set()
  Eigen::Matrix3Xd external_, u_, k_u_;
  Eigen::MatrixXd rhs_;
};

}  // namespace palpate::elasticity
