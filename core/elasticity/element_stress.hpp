#pragma once

#include <memory>

#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

/// Elastic stress in each element of a body, Pa: mean over its deformed volume, without damping
/// stress.
struct ElementStress {
  Eigen::Matrix<double, 6, Eigen::Dynamic> cauchy;  // xx yy zz xy xz yz, in the axes of O
  Eigen::VectorXd von_mises;                        // von Mises stress of that mean
};

/// sqrt(3/2 |s|^2), s the deviator of a stress (xx yy zz xy xz yz); invariant under rotation.
double von_mises(const Eigen::Matrix<double, 6, 1>& stress);

/// Evaluates stresses of four elements at once. Keeps the rotations of the last shape as starting
/// points; not thread-safe.
class StressEvaluator {
 public:
  virtual ~StressEvaluator() = default;

  /// At positions x (3 x n):
  ///   sigma = sum_p w_p P F^T / sum_p w_p det F   over the quadrature points,
  ///   P F^T = R (2 mu E + lambda tr(E) I) (I + E) R^T, E = R^T F - I, with the linear law.
  /// The volume of an element that is inverted or compressed to less than a hundredth counts as
  /// that hundredth, so that its stress remains finite. Allocates if `out` has a different size.
  virtual void evaluate(const Eigen::Matrix3Xd& x, ElementStress& out) noexcept = 0;
};

std::unique_ptr<StressEvaluator> make_stress_evaluator(const ElementSet& elements);

/// For tools: one evaluation including set-up. Throws std::invalid_argument if the body is invalid
/// or x has a different number of nodes.
ElementStress element_stress(const Body& body, const Eigen::Matrix3Xd& x);

}  // namespace palpate::elasticity
