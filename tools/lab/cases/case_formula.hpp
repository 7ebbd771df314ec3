#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace palpate::cases {

/// A vector field of rest positions written as text, for instance
/// "traction t(y,z) = (6*T/a^4) * (0, -(z-a/2), (y-a/2)) Pa on the face": what follows the first
/// '=' up to the first word that no operator joins on. Knows + - * / ^ **, brackets, vectors
/// (a, b, c), sqrt, sin, cos, exp, abs, pi, x, y and z; other names are constants.
class VectorFormula {
 public:
  /// `constant` gives the value of a name, or throws. Throws std::invalid_argument where the text
  /// cannot be read or is no vector.
  VectorFormula(const std::string& text, const std::function<double(const std::string&)>& constant);

  Eigen::Vector3d operator()(const Eigen::Vector3d& position) const { return field_(position); }

 private:
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> field_;
};

}  // namespace palpate::cases
