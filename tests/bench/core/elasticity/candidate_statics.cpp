#include "tests/bench/core/elasticity/candidate_statics.hpp"

#include <algorithm>
#include <cmath>

#include "core/factor/supernodal_factor.hpp"
#include "core/math/polar.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;

constexpr int kMostIterations = 60;  // of Newton, for one step of the load
constexpr int kMostSteps = 64;

class Newton {
 public:
  Newton(const elasticity::Body& body, Volumetric volumetric, factor::Held held)
      : elements_(body, volumetric),
        pattern_(elements_.stencils(), body.mesh.node_count(), body.fixed_nodes,
                 elasticity::patches(body)),
        supernodes_(pattern_),
        matrix_(pattern_),
        factor_(supernodes_),
        held_(held),
        rest_(body.mesh.nodes) {
    const double size =
        (body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff()).norm();
    tolerance_ = std::max(1e-10, 1e-13 * body.material.young_modulus * size * size);
  }

  bool solve(const Matrix3Xd& loads, Matrix3Xd& x) {
    double energy = evaluate(loads, x);
    for (int i = 0; i < kMostIterations && std::isfinite(energy); ++i) {
      const double before = residual();
      if (before <= tolerance_) return true;
      if (!factorise(true) && !factorise(false)) return false;
      const Matrix3Xd dx = correction(x.cols()), start = x;
      const double slope = forces_.cwiseProduct(dx).sum();
      bool accepted = false;
      for (double alpha = 1; alpha > 1e-6 && !accepted; alpha /= 2) {
        x = start + alpha * dx;
        const double next = evaluate(loads, x);
        const double rounding = 1e-12 * (std::abs(energy) + std::abs(next));
        accepted = next <= energy + 1e-4 * alpha * slope ||
                   (std::abs(next - energy) <= rounding && residual() < before);
        if (accepted) energy = next;
      }
      if (!accepted) return false;
    }
    return std::isfinite(energy) && residual() <= tolerance_;
  }

 private:
  double evaluate(const Matrix3Xd& loads, const Matrix3Xd& x) {
    const double energy = elements_.evaluate(x, forces_);
    forces_ -= loads;
    return energy - loads.cwiseProduct(x - rest_).sum();
  }

  double residual() const {
    double largest = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      if (!pattern_.is_free(k, held_)) continue;
      largest = std::max(largest, forces_.col(pattern_.node(k)).norm());
    }
    return largest;
  }

  bool factorise(bool exact) {
    matrix_.set_zero();
    elements_.add_tangent(exact, matrix_);
    return factor_.factorise(matrix_) && factor_.is_positive(held_);
  }

  Matrix3Xd correction(Eigen::Index nodes) const {
    Eigen::MatrixXd b(3 * pattern_.size(), 1);
    for (int k = 0; k < pattern_.size(); ++k) {
      b.block<3, 1>(3 * k, 0) = -forces_.col(pattern_.node(k));
    }
    factor_.solve(b, held_);
    Matrix3Xd dx = Matrix3Xd::Zero(3, nodes);
    for (int k = 0; k < pattern_.size(); ++k) dx.col(pattern_.node(k)) = b.block<3, 1>(3 * k, 0);
    return dx;
  }

  CandidateElements elements_;
  factor::BlockPattern pattern_;
  factor::Supernodes supernodes_;
  factor::BlockMatrix matrix_;
  factor::SupernodalFactor factor_;
  factor::Held held_;
  Matrix3Xd rest_, forces_;
  double tolerance_;
};

}  // namespace

CandidateSolution solve_candidate(const elasticity::Body& body, Volumetric volumetric,
                                  const Matrix3Xd& loads, const elasticity::HeldPoses& held) {
  Newton newton(body, volumetric, {held[0].has_value(), held[1].has_value()});
  CandidateSolution solution;
  for (int steps = 1; steps <= kMostSteps && !solution.converged; steps *= 2) {
    solution.positions = body.mesh.nodes;
    solution.converged = true;
    for (int s = 1; s <= steps && solution.converged; ++s) {
      const double share = static_cast<double>(s) / steps;
      for (std::size_t g = 0; g < body.grasps.size(); ++g) {
        if (!held[g]) continue;
        const math::Pose motion = *held[g] * body.grasps[g].X_OG_rest.inverse();
        const math::Pose part =
            math::make_pose(math::exp_rotation(share * math::log_rotation(motion.linear())),
                            share * motion.translation());
        for (const int node : body.grasps[g].nodes) {
          solution.positions.col(node) = part * body.mesh.nodes.col(node);
        }
      }
      solution.converged = newton.solve(share * loads, solution.positions);
    }
  }
  return solution;
}

}  // namespace palpate::bench
