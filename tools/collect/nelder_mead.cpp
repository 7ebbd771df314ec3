#include "tools/collect/nelder_mead.hpp"

#include <algorithm>
#include <vector>

namespace palpate::collect {

using Eigen::VectorXd;

VectorXd minimise(const std::function<double(const VectorXd&)>& cost, const VectorXd& start,
                  const VectorXd& steps, int evaluations) {
  struct Corner {
    VectorXd x;
    double cost;
    bool operator<(const Corner& other) const { return cost < other.cost; }
  };
  const auto at = [&](const VectorXd& x) {
    --evaluations;
    return Corner{x, cost(x)};
  };
  std::vector<Corner> corners{at(start)};
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    VectorXd x = start;
    x[i] += steps[i];
    corners.push_back(at(x));
  }
  while (evaluations > 0) {
    std::sort(corners.begin(), corners.end());
    VectorXd centre = VectorXd::Zero(start.size());
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) centre += corners[i].x;
    centre /= static_cast<double>(start.size());
    Corner& worst = corners.back();
    const auto along = [&](double t) { return at(centre + t * (worst.x - centre)); };
    const Corner mirrored = along(-1);
    if (mirrored < corners.front()) {
      worst = std::min(mirrored, along(-2));
    } else if (mirrored < corners[corners.size() - 2]) {
      worst = mirrored;
    } else {
      const Corner inner = along(mirrored < worst ? -0.5 : 0.5);
      if (inner < std::min(mirrored, worst)) {
        worst = inner;
      } else {
        for (std::size_t i = 1; i < corners.size(); ++i)
          corners[i] = at(0.5 * (corners[0].x + corners[i].x));
      }
    }
  }
  return std::min_element(corners.begin(), corners.end())->x;
}

}  // namespace palpate::collect
