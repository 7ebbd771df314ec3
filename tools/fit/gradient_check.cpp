#include "tools/fit/gradient_check.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Side of the parameters on which differences are taken.
enum class Side { kBelow = -1, kBoth = 0, kAbove = 1 };

/// Difference quotient of a member's prediction with respect to one coordinate.
VectorXd difference(const Problem& problem, int member, VectorXd x, Index i, double h, Side side) {
  const double middle = x[i];
  VectorXd above, below;
  x[i] = side == Side::kBelow ? middle : middle + h;
  const double upper = x[i];
  bool is_good = problem.predict(member, x, above, nullptr);
  x[i] = side == Side::kAbove ? middle : middle - h;
  is_good = problem.predict(member, x, below, nullptr) && is_good;
  if (!is_good) throw std::runtime_error("no equilibrium next to the parameters to be checked");
  return (above - below) / (upper - x[i]);
}

/// Ridders' method: steps shrink while Neville's scheme extrapolates to zero; by sample, the entry
/// of the table with the smallest estimated error.
VectorXd extrapolated(const Problem& problem, int member, const VectorXd& x, Index i, double h,
                      Side side, VectorXd& error) {
  constexpr int kRows = 10;
  constexpr double kShrink = 1.6;
  // Errors of central differences are even in the step, those of one-sided ones contain all powers.
  const double power = side == Side::kBoth ? kShrink * kShrink : kShrink;
  std::array<std::array<VectorXd, kRows>, kRows> table;
  VectorXd best;
  for (int row = 0; row < kRows; ++row, h /= kShrink) {
    table[row][0] = difference(problem, member, x, i, h, side);
    if (row == 0) {
      best = table[0][0];
      error.setConstant(best.size(), std::numeric_limits<double>::infinity());
    }
    double factor = power;
    for (int k = 1; k <= row; ++k, factor *= power) {
      table[row][k] = (factor * table[row][k - 1] - table[row - 1][k - 1]) / (factor - 1);
      const VectorXd off = (table[row][k] - table[row][k - 1])
                               .cwiseAbs()
                               .cwiseMax((table[row][k] - table[row - 1][k - 1]).cwiseAbs());
      for (Index n = 0; n < off.size(); ++n)
        if (off[n] < error[n]) error[n] = off[n], best[n] = table[row][k][n];
    }
  }
  return best;
}

/// By sample, the deviation of the derivatives from differences, minus twice Ridders' own error.
/// Near a kink only short steps are valid, elsewhere long ones are more accurate; at a kink, where
/// a contact fit often ends, there are two one-sided derivatives: the closer one counts.
VectorXd distance(const Problem& problem, int member, const VectorXd& x, Index i, double step,
                  const VectorXd& derivative, double enough) {
  VectorXd nearest;
  for (const Side side : {Side::kBoth, Side::kBelow, Side::kAbove}) {
    for (const double share : {1.0, 1e-2, 1e-4}) {
      VectorXd error;
      const VectorXd numeric = extrapolated(problem, member, x, i, share * step, side, error);
      const VectorXd off = ((derivative - numeric).cwiseAbs() - 2 * error).cwiseMax(0);
      nearest = nearest.size() == 0 ? off : VectorXd(nearest.cwiseMin(off));
    }
    if (nearest.maxCoeff() <= enough) break;
  }
  return nearest;
}

}  // namespace

std::vector<GradientCheck> check_gradients(const Problem& problem, const VectorXd& coordinates) {
  constexpr double kStep = 0.02, kLeast = 1e-4;
  std::vector<GradientCheck> checks;
  const VectorXd lower = problem.lower(), upper = problem.upper();
  for (std::size_t m = 0; m < problem.members().size(); ++m) {
    const int member = static_cast<int>(m);
    VectorXd prediction;
    MatrixXd J;
    if (!problem.predict(member, coordinates, prediction, &J))
      throw std::runtime_error("no equilibrium with the parameters to be checked");
    for (Index i = 0; i < coordinates.size(); ++i) {
      if (J.col(i).isZero(0)) continue;
      const double room = std::min(coordinates[i] - lower[i], upper[i] - coordinates[i]);
      const double step = std::min(kStep, 0.5 * room);
      if (!(step > 1e-6)) continue;  // at a bound
      const auto size_of = [&](Index row, Index n) {
        return std::max(J.col(i).segment(row, n).cwiseAbs().maxCoeff(),
                        kLeast * prediction.segment(row, n).cwiseAbs().maxCoeff());
      };
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s < problem.series().size(); ++s) {
        if (problem.series()[s].member != member) continue;
        const double size = size_of(problem.series()[s].row, problem.series_at(s).measured.size());
        if (size > 0) least = std::min(least, size);
      }
      const VectorXd off =
          distance(problem, member, coordinates, i, step, J.col(i), kGradientTolerance * least);
      const auto parameter = static_cast<std::size_t>(problem.free()[i]);
      for (std::size_t s = 0; s < problem.series().size(); ++s) {
        if (problem.series()[s].member != member) continue;
        const Index row = problem.series()[s].row, n = problem.series_at(s).measured.size();
        const double size = size_of(row, n);
        if (!(size > 0)) continue;
        const double relative = off.segment(row, n).maxCoeff() / size;
        const std::string& quantity = problem.series_at(s).quantity;
        auto found = std::find_if(checks.begin(), checks.end(),
                                  [&](const GradientCheck& c) { return c.quantity == quantity; });
        if (found == checks.end()) found = checks.insert(checks.end(), {quantity, "", -1});
        if (relative <= found->difference) continue;
        found->difference = relative;
        found->parameter = problem.parameters()[parameter].name;
      }
    }
  }
  return checks;
}

}  // namespace palpate::fit
