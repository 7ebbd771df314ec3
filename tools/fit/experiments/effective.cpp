#include "tools/fit/experiments/effective.hpp"

#include <algorithm>
#include <cmath>

#include "core/solid/strain_energy.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A material's fitted constants.
struct Constants {
  VectorXd values;
  std::vector<int> parameters;  // of the problem
};

std::optional<Constants> find_constants(const Fit& fit, const solid::StrainEnergy& energy) {
  Constants result;
  result.values.resize(static_cast<Index>(energy.constants().size()));
  for (std::size_t i = 0; i < energy.constants().size(); ++i) {
    const Estimate* const estimate = fit.find(energy.constants()[i].name);
    if (!estimate) return std::nullopt;
    result.values[i] = estimate->value;
    result.parameters.push_back(static_cast<int>(estimate - fit.uncertainty.estimates.data()));
  }
  return result;
}

/// Standard deviation of a quantity with the derivatives `by_constant`.
double deviation(const Problem& problem, const Fit& fit, const Constants& constants,
                 const VectorXd& by_constant) {
  VectorXd g = VectorXd::Zero(static_cast<Index>(problem.free().size()));
  for (std::size_t i = 0; i < constants.parameters.size(); ++i) {
    const auto free =
        std::find(problem.free().begin(), problem.free().end(), constants.parameters[i]);
    if (free == problem.free().end()) continue;
    const auto k = static_cast<Index>(i);
    g[free - problem.free().begin()] =
        by_constant[k] * problem.slope(constants.parameters[i], constants.values[k]);
  }
  return std::sqrt(std::max(0.0, g.dot(fit.uncertainty.coordinate_covariance * g)));
}

/// A secant and its derivatives.
struct Secant {
  double value = 0;
  VectorXd by_constant;
};

/// Those of stress and, negative, of lateral strain. False without equilibrium.
bool find_secants(const solid::StrainEnergy& energy, const VectorXd& constants,
                  const std::array<double, 2>& range, Secant& modulus, Secant& poisson) {
  constexpr int kPoints = 100;
  modulus = poisson = {0, VectorXd::Zero(constants.size())};
  double squares = 0;
  solid::UniaxialStress r;
  for (int k = 0; k <= kPoints; ++k) {
    const double e = range[0] + (range[1] - range[0]) * k / static_cast<double>(kPoints);
    if (!respond_uniaxially(energy, constants, 1 + e, r)) return false;
    squares += e * e;
    modulus.value += e * r.stress;
    modulus.by_constant += e * r.by_constant;
    poisson.value -= e * (r.lateral - 1);
    poisson.by_constant -= e * r.lateral_by_constant;
  }
  for (Secant* secant : {&modulus, &poisson}) {
    secant->value /= squares;
    secant->by_constant /= squares;
  }
  return true;
}

}  // namespace

std::optional<EffectiveMaterial> effective_material(const Problem& problem, const Fit& fit,
                                                    const std::string& material,
                                                    const std::array<double, 2>& strain_range) {
  const std::vector<std::string>& known = solid::StrainEnergy::names();
  if (std::find(known.begin(), known.end(), material) == known.end()) return std::nullopt;
  const auto energy = solid::StrainEnergy::make(material);
  const std::optional<Constants> constants = find_constants(fit, *energy);
  if (!constants) return std::nullopt;
  const Index n = constants->values.size();
  Secant modulus{constants->values[0], VectorXd::Unit(n, 0)};
  Secant poisson{constants->values[1], VectorXd::Unit(n, 1)};
  if (material != "linear" && strain_range[1] > strain_range[0]) {
    Secant lateral;
    if (!find_secants(*energy, constants->values, strain_range, modulus, lateral))
      return std::nullopt;
    if (constants->values[1] < 0.5) poisson = lateral;
  }
  // 1.96 standard deviations; for E in its logarithm, so that both ends are positive.
  const double relative = deviation(problem, fit, *constants, modulus.by_constant) / modulus.value;
  if (!(modulus.value > 0) || !(relative < std::log(2.0))) return std::nullopt;
  const double wide = 1.96 * deviation(problem, fit, *constants, poisson.by_constant);
  const auto allowed = [](double nu) { return std::min(nu, kGreatestEffectivePoisson); };
  EffectiveMaterial result;
  result.strain_range = strain_range;
  result.young_modulus = modulus.value;
  result.modulus_interval = {modulus.value * std::exp(-1.96 * relative),
                             modulus.value * std::exp(1.96 * relative)};
  result.poisson_ratio = allowed(poisson.value);
  result.poisson_interval = {allowed(poisson.value - wide), allowed(poisson.value + wide)};
  // A quantity with its own interval keeps it, which may be by profile.
  const Estimate& own = *fit.find("young_modulus");
  if (material == "linear" && own.standing == Standing::kEstimated)
    result.modulus_interval = own.interval;
  return result;
}

}  // namespace palpate::fit
