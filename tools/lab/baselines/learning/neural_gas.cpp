#include "tools/lab/baselines/learning/neural_gas.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Edge = std::pair<int, int>;

Edge edge_of(int a, int b) { return std::minmax(a, b); }

class Gas {
 public:
  Gas(const Eigen::Matrix3Xd& points, const NeuralGasOptions& options, math::Random random)
      : points_(points), options_(options), random_(random) {
    units_.push_back(any());
    units_.push_back(any());
    errors_.assign(2, 0);
  }

  void run() {
    const long steps = static_cast<long>(options_.rounds) * points_.cols();
    for (long step = 1; step <= steps; ++step) {
      meet(any());
      if (step % options_.grow_every == 0 && static_cast<int>(units_.size()) < options_.units)
        grow();
    }
    while (static_cast<int>(units_.size()) < options_.units) grow();
  }

  NeuralGas result() const {
    NeuralGas gas;
    gas.units.resize(3, static_cast<Eigen::Index>(units_.size()));
    for (std::size_t i = 0; i < units_.size(); ++i)
      gas.units.col(static_cast<Eigen::Index>(i)) = units_[i];
    for (const auto& [edge, age] : ages_) gas.edges.push_back(edge);
    return gas;
  }

 private:
  Eigen::Vector3d any() {
    return points_.col(
        static_cast<Eigen::Index>(random_.below(static_cast<std::uint64_t>(points_.cols()))));
  }

  void meet(const Eigen::Vector3d& point) {
    int first = -1, second = -1;
    double least = 0, less = 0;
    for (int i = 0; i < static_cast<int>(units_.size()); ++i) {
      const double squared = (units_[i] - point).squaredNorm();
      if (first < 0 || squared < least) {
        second = first;
        less = least;
        first = i;
        least = squared;
      } else if (second < 0 || squared < less) {
        second = i;
        less = squared;
      }
    }
    errors_[first] += least;
    units_[first] += options_.winner * (point - units_[first]);
    for (auto at = ages_.begin(); at != ages_.end();) {
      const auto [a, b] = at->first;
      if (a == first || b == first) {
        const int other = a == first ? b : a;
        units_[other] += options_.neighbour * (point - units_[other]);
        ++at->second;
      }
      at = at->second > options_.oldest ? ages_.erase(at) : std::next(at);
    }
    ages_[edge_of(first, second)] = 0;
    for (double& error : errors_) error *= options_.forget;
  }

  /// Adds a unit between the one with the largest error and its worst neighbour, or the nearest
  /// unit if it has no neighbour.
  void grow() {
    const int worst =
        static_cast<int>(std::max_element(errors_.begin(), errors_.end()) - errors_.begin());
    int partner = -1;
    for (const auto& [edge, age] : ages_) {
      if (edge.first != worst && edge.second != worst) continue;
      const int other = edge.first == worst ? edge.second : edge.first;
      if (partner < 0 || errors_[other] > errors_[partner]) partner = other;
    }
    if (partner < 0) partner = worst == 0 ? 1 : 0;
    const int added = static_cast<int>(units_.size());
    units_.push_back(0.5 * (units_[worst] + units_[partner]));
    ages_.erase(edge_of(worst, partner));
    ages_[edge_of(worst, added)] = 0;
    ages_[edge_of(partner, added)] = 0;
    errors_[worst] *= 0.5;
    errors_[partner] *= 0.5;
    errors_.push_back(errors_[worst]);
  }

  const Eigen::Matrix3Xd& points_;
  NeuralGasOptions options_;
  math::Random random_;
  std::vector<Eigen::Vector3d> units_;
  std::vector<double> errors_;
  std::map<Edge, int> ages_;
};

}  // namespace

NeuralGas grow_neural_gas(const Eigen::Matrix3Xd& points, const NeuralGasOptions& options,
                          math::Random random) {
  if (options.units < 2 || points.cols() < options.units)
    throw std::invalid_argument("a neural gas wants two units at least, and as many points");
  if (options.rounds < 1 || options.grow_every < 1 || options.oldest < 1 || !(options.winner > 0) ||
      !(options.neighbour >= 0))
    throw std::invalid_argument("a neural gas' option is out of range");
  Gas gas(points, options, random);
  gas.run();
  return gas.result();
}

}  // namespace palpate::baselines
