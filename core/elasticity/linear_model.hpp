#pragma once

#include "core/elasticity/block_ldl.hpp"
#include "core/elasticity/comparison_model.hpp"

namespace palpate::elasticity {

/// Small-displacement statics, K u = loads + weight, with one factor of the constant K for each set
/// of held grasps, all made by prepare(). Linear and quadratic tetrahedra, E by element. Grasped
/// nodes follow the hand exactly, but the rest of the body answers linearly: it swells where it
/// turns, so that shape and force are right for small rotations only.
///
/// The reaction's lever arms are those of the moved patch, which makes the wrench the derivative of
/// the model's energy by the hand's motion. The sensitivity is exact and of age zero after every
/// step; dw_dxi holds for loads that stay. step() fails where nothing holds the body in place.
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
  // How the body answers the twelve parameters of an affine motion of one patch, A r + t: columns t
  // (3), then A column by column (9); r from the origin of G at rest.
  using Affine = Eigen::Matrix<double, Eigen::Dynamic, 12>;
  struct Factor {
    explicit Factor(const BlockPattern& pattern) : held(pattern.size(), 0), ldl(pattern) {}
    bool usable = false;
    std::vector<char> held;  // by unknown
    BlockLdl ldl;
    std::array<Affine, 2> shape;  // displacements, 3 n rows
    std::array<Affine, 2> force;  // of the hand on its patch, 3 rows for each of its nodes
  };

  StepReport advance(double dt) noexcept override;
  template <int kNodes>
  void assemble();
  void solve(const Factor& factor) noexcept;
  void respond(Factor& factor, int grasp);
  void update_sensitivity(const Factor& factor) noexcept;
  void forget_sensitivity() noexcept;

  BlockPattern pattern_;
  BlockMatrix stiffness_;
  Eigen::VectorXd nodal_mass_;   // kg
  std::vector<Factor> factors_;  // by HeldNodes::held_set()
  Eigen::Matrix3Xd external_, u_, k_u_;
  Eigen::Matrix4Xd rhs_;
  std::array<Eigen::Matrix<double, Eigen::Dynamic, 6>, 2> spare_;  // storage of what is not held
};

}  // namespace palpate::elasticity
