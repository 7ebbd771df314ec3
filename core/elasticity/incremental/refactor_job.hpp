#pragma once

#include <memory>

#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/incremental/loop_factor.hpp"
#include "core/elasticity/incremental/numbered_body.hpp"
#include "core/elasticity/incremental/solver_options.hpp"
#include "core/elasticity/static_response.hpp"

namespace palpate::elasticity {

/// Assembles the tangent at a snapshot, factors it for the loop and derives from the exact static
/// tangent the sensitivity of the equilibrium to grasps, parameters and contacts. Snapshot and
/// results are plain members: the model fills the former before run() and reads the latter after
/// it.
class RefactorJob final : public Refactorisation {
 public:
  /// `body` and `samples` (of LoopFactor) must outlive this object. The options' team is used by
  /// the loop when it solves with the factor; the job itself runs in the calling thread.
  RefactorJob(const NumberedBody& body, const SolverOptions& options,
              const std::vector<mesh::PointWeights>& samples);

  void run() noexcept override;

  Snapshot snapshot;                 // further inputs: factor.rotations, factor.step
  std::vector<int> contact_samples;  // whose compliances are wanted

  // Results.
  LoopFactor factor;
  Sensitivity sensitivity;

 private:
  void assemble(Tangent kind);
  void add_step();
  bool factorise(double shift = 0);

  const factor::BlockPattern& pattern_;
  std::unique_ptr<ElementTangents> tangents_;
  factor::BlockMatrix matrix_, warped_;
  Eigen::VectorXd mass_;  // kg, by block
  std::unique_ptr<factor::SupernodalFactor> factorisation_;
  StaticResponse response_;
  std::unique_ptr<StressEvaluator> stress_;
};

}  // namespace palpate::elasticity
