#pragma once

#include <memory>

#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

/// Elastic stress in each element of a body, Pa: the mean over its volume as deformed. Damping
/// counts for nothing.
struct ElementStress {
  Eigen::Matrix<double, 6, Eigen::Dynamic> cauchy;  // xx yy zz xy xz yz, in the axes of O
  Eigen::VectorXd von_mises;                        // of that mean
};

/// sqrt(3/2 |s|^2), s the deviator of a stress (xx yy zz xy xz yz); no turn changes it.
double von_mises(const Eigen::Matrix<double, 6, 1>& stress);

/// Evaluates stresses four elements side by side. Remembers the rotations of the last shape, from
/// which the next search for them starts; one thread uses it at a time.
class StressEvaluator {
 public:
  virtual ~StressEvaluator() = default;

  /// At positions x (3 x n):
  ///   sigma = sum_p w_p P F^T / sum_p w_p det F   over the quadrature points,
  /// P F^T = R (2 mu E + lambda tr(E) I) (I + E) R^T, E = R^T F - I. An element that is crushed to
  /// less than a hundredth of its volume, or inside out, counts as that hundredth, so that its
  /// stress stays a number. Allocates where `out` has another size.
  virtual void evaluate(const Eigen::Matrix3Xd& x, ElementStress& out) noexcept = 0;
};

std::unique_ptr<StressEvaluator> make_stress_evaluator(const ElementSet& elements);

/// For tools: sets up and evaluates once. Throws std::invalid_argument where the body is not in
/// order or x has another number of nodes.
ElementStress element_stress(const Body& body, const Eigen::Matrix3Xd& x);

}  // namespace palpate::elasticity
