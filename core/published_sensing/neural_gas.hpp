#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::published_sensing {

/// Growing neural gas (B. Fritzke, "A growing neural gas network learns topologies", NIPS 1994):
/// units that spread over a set of points, and edges between neighbours. For set-up: allocates.
struct NeuralGasOptions {
  int units = 24;        // that it grows to, at least 2
  int rounds = 400;      // over all points, in random order
  int grow_every = 100;  // points, until a unit is added where the error is largest
  double winner = 0.05;  // share of the way that the nearest unit goes to a point
  double neighbour = 0.006;
  int oldest = 50;        // points that an edge lasts without being met
  double forget = 0.995;  // of the units' errors, each point
};

struct NeuralGas {
  Eigen::Matrix3Xd units;                  // m
  std::vector<std::pair<int, int>> edges;  // a < b, sorted
};

/// Throws std::invalid_argument where there are fewer points than units, or an option is out of
/// range.
NeuralGas grow_neural_gas(const Eigen::Matrix3Xd& points, const NeuralGasOptions& options,
                          math::Random random);

}  // namespace palpate::published_sensing
