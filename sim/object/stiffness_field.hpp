#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::object {

struct StiffnessFieldOptions {
  double deviation = 0;    // standard deviation of log E; 0: uniform
  double length = 0.1;     // m, correlation length
  std::uint64_t seed = 1;  // same seed, same field
};

/// Smooth random field of Young's modulus relative to its median: exp(deviation * g), with g a
/// Gaussian field of mean 0, variance 1 and correlation exp(-r^2 / (2 length^2)), of which values
/// beyond +-kMostDeviations are held there. Mean and variance are those over all seeds: an object
/// that is not much larger than the correlation length is stiffer or softer as a whole, too.
class StiffnessField {
 public:
  static constexpr double kMostDeviations = 2;

  /// Throws std::invalid_argument.
  explicit StiffnessField(const StiffnessFieldOptions& options);

  /// Factor on the modulus at a rest point (m, in O).
  double factor(const Eigen::Vector3d& p_O) const;

 private:
  // Sum of cosines of random direction, wavelength and phase: the field's spectrum is that of the
  // correlation, a normal distribution of wave vectors (Shinozuka 1971).
  struct Wave {
    Eigen::Vector3d vector;  // rad/m
    double phase;            // rad
  };

  double deviation_;
  std::vector<Wave> waves_;
};

}  // namespace palpate::object
