#pragma once

#include <Eigen/Core>
#include <array>

#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/static_response.hpp"
#include "core/factor/solve_panels.hpp"

namespace palpate::elasticity {

/// Limited-memory quasi-Newton update: pairs of a correction and the resulting change of force
/// improve a slightly outdated factor (L-BFGS, Nocedal 1980, with that factor as initial matrix).
/// The length of the vectors is the number of unknown coordinates.
class SecantPairs {
 public:
  explicit SecantPairs(int size);

  void clear() noexcept { count_ = 0; }

  /// Stores the pair in place of the oldest; rejects one without positive curvature.
  void add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept;

  /// Overwrites b with an improved solution of A x = b; `solve(b)` applies the factor.
  template <class Solve>
  void apply(Eigen::VectorXf& b, const Solve& solve) noexcept {
    std::array<float, kPairs> a;
    for (int k = 0; k < count_; ++k) {
      const Pair& pair = newest(k);
      a[k] = pair.scale * dot(pair.step, b);
      b -= a[k] * pair.change;
    }
    solve(b);
    for (int k = count_ - 1; k >= 0; --k) {
      const Pair& pair = newest(k);
      b += (a[k] - pair.scale * dot(pair.change, b)) * pair.step;
    }
  }

 private:
  static constexpr int kPairs = 6;
  struct Pair {
    Eigen::VectorXf step, change;
    float scale = 0;  // 1 / step . change
  };
  static float dot(const Eigen::VectorXf& a, const Eigen::VectorXf& b) noexcept { return a.dot(b); }
  const Pair& newest(int k) const noexcept { return pairs_[(next_ + kPairs - 1 - k) % kPairs]; }

  std::array<Pair, kPairs> pairs_;
  int next_ = 0;
  int count_ = 0;
};

/// Coefficients of the loop's matrix: inertia M + K + viscous K_warped. Zero if quasi-static.
struct StepFactors {
  double inertia = 0;  // 1/s^2: 1/h^2 + mass factor / h
  double viscous = 0;  // stiffness factor / h
};

/// Factor used by the loop, and the state from which it was computed.
struct LoopFactor {
  LoopFactor(const factor::Supernodes& supernodes, factor::PanelPrecision precision,
             math::Team& team)
      : panels(supernodes, precision, team),
        rotations(Eigen::Matrix4Xf::Zero(4, supernodes.pattern().size())) {
    rotations.row(0).setOnes();
  }

  factor::SolvePanels panels;
  Eigen::Matrix4Xf rotations;  // rotations of the unknown nodes at the snapshot, w x y z
  StepFactors step;
  bool usable = false;
  bool exact = false;        // computed from the exact tangent
  bool regularised = false;  // shifted, because the body is unsupported
};

/// Assembles the tangent at a snapshot, factors it for the loop and derives from the exact static
/// tangent the sensitivity of the equilibrium to grasps, parameters and contacts. Snapshot and
/// results are plain members: the model fills the former before run() and reads the latter after
/// it.
class RefactorJob final : public Refactorisation {
 public:
  /// `team` is used by the loop when it solves with the factor; the job itself runs in the calling
  /// thread.
  RefactorJob(const Body& body, const ElementSet& elements, const factor::Supernodes& supernodes,
              factor::PanelPrecision precision, math::Team& team);

  void run() noexcept override;

  Snapshot snapshot;  // further inputs: factor.rotations, factor.step

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
  factor::SupernodalFactor factorisation_;
  StaticResponse response_;
  std::unique_ptr<StressEvaluator> stress_;
};

/// Product of the exact static tangent at the present shape and a sensitivity column, as a central
/// difference of element forces without assembling a matrix. Relative error about 1e-4, from the
/// nonlinearity of the forces over the difference.
class TangentProduct {
 public:
  TangentProduct(const Body& body, const std::vector<Lame>& materials,
                 const std::vector<int>& numbering, Precision precision);

  /// Product (N per unit of the column's motion) at positions `x` (m), in their node numbering.
  const NodalField& multiply(const NodalField& x, const NodalField& column) noexcept;

 private:
  std::unique_ptr<ElementForces> forces_;
  double move_;  // m, displacement of the node that moves most
  NodalField x_, forward_, backward_;
};

}  // namespace palpate::elasticity
