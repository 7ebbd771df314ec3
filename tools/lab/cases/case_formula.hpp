#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace palpate::cases {

/// A vector field of rest positions written as text, for instance "traction t(y,z) = (6*T/a^4) *
/// (0, -(z-a/2), (y-a/2)) Pa on the face": the part after the first '=' up to the first word not
/// joined by an operator. Supports + - * / ^ **, brackets, vectors (a, b, c), sqrt, sin, cos, exp,
/// abs, pi, x, y and z; other names are constants.
class VectorFormula {
 public:
  /// `constant` returns the value of a name, or throws. Throws std::invalid_argument if the text
  /// cannot be parsed or is not a vector.
  VectorFormula(const std::string& text, const std::function<double(const std::string&)>& constant);

  Eigen::Vector3d operator()(const Eigen::Vector3d& position) const { return field_(position); }

 private:
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> field_;
};

}  // namespace palpate::cases
