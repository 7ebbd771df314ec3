#pragma once

#include <array>
#include <vector>

#include "core/elasticity/block_ldl.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

/// What the loop's matrix is made of: inertia M + K + viscous K_warped. Zero where quasi-static.
struct StepFactors {
  double inertia = 0;  // 1/s^2: 1/h^2 + mass factor / h
  double viscous = 0;  // stiffness factor / h
};

/// Factor that a loop solves with, and what it was made from.
struct LoopFactor {
  explicit LoopFactor(const BlockPattern& pattern, const ElementSet& elements)
      : ldl(pattern), held(pattern.size(), 0), state(elements.make_state()) {}

  BlockLdl ldl;
  std::vector<char> held;   // by unknown: not free while this factor is used
  ElementSet::State state;  // rotations of the snapshot
  StepFactors step;
  bool usable = false;
  bool exact = false;        // of the exact tangent
  bool regularised = false;  // shifted, since nothing stops the body from moving as a whole
};

/// Assembles the tangent at a snapshot, factors it for the loop and derives how equilibrium follows
/// the grasps from the exact static tangent. Snapshot and result are plain members; the model fills
/// the first before run() and takes the second after it.
class RefactorJob final : public Refactorisation {
 public:
  RefactorJob(const ElementSet& elements, const BlockPattern& pattern,
              const std::vector<GraspRegion>& grasps);

  void run() noexcept override;

  // Snapshot: factor.held, factor.state, factor.step and these.
  Eigen::Matrix3Xd positions;
  Eigen::Matrix3Xd external;  // N, loads and weight
  std::array<bool, 2> is_held{false, false};
  std::array<Eigen::Vector3d, 2> origins{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  // of G

  // Result.
  LoopFactor factor;
  Sensitivity sensitivity;

 private:
  void assemble(Tangent kind, const StepFactors& step);
  bool factorise(Tangent kind, const StepFactors& step);
  void respond(int grasp);

  const ElementSet& elements_;
  const BlockPattern& pattern_;
  const std::vector<GraspRegion>& grasps_;
  BlockMatrix matrix_;
  ElementSet::State state_;
  Eigen::MatrixXd element_matrix_;
  Eigen::Matrix3Xd forces_, u_, k_u_;
  Eigen::Matrix4Xd rhs_;
};

}  // namespace palpate::elasticity
