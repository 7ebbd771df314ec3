#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::baselines {

/// Growing neural gas (B. Fritzke, "A growing neural gas network learns topologies", NIPS 1994):
/// units distributed over a set of points, and edges between neighbours. For set-up: allocates.
struct NeuralGasOptions {
  int units = 24;        // final number of units, at least 2
  int rounds = 400;      // passes over all points, in random order
  int grow_every = 100;  // points between additions of a unit where the error is largest
  double winner = 0.05;  // fraction of the distance by which the nearest unit moves towards a point
  double neighbour = 0.006;
  int oldest = 50;        // points after which an unused edge is removed
  double forget = 0.995;  // decay factor of the units' errors per point
};

struct NeuralGas {
  Eigen::Matrix3Xd units;                  // m
  std::vector<std::pair<int, int>> edges;  // a < b, sorted
};

/// Throws std::invalid_argument if there are fewer points than units or an option is out of range.
NeuralGas grow_neural_gas(const Eigen::Matrix3Xd& points, const NeuralGasOptions& options,
                          math::Random random);

}  // namespace palpate::baselines
