#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/fit/fit.hpp"

namespace palpate::fit {

/// The linear co-rotational material closest to the fitted one.
struct EffectiveMaterial {
  double young_modulus = 0;  // Pa
  double poisson_ratio = 0;
  std::array<double, 2> modulus_interval{};  // 95 %; both the value if none is known
  std::array<double, 2> poisson_interval{};
  std::array<double, 2> strain_range{};  // range of validity
};

/// Largest Poisson's ratio of the co-rotational model: its elements lock above it.
inline constexpr double kGreatestEffectivePoisson = 0.49;

/// E is the slope through the origin with the least squared stress error over `strain_range` of a
/// bar with free sides, nu that of its lateral strain (of small strain for incompressible
/// materials), at most kGreatestEffectivePoisson; for a `linear` material its own. Intervals by the
/// delta method, with open directions limited to the range of their coordinates: individual
/// constants may be open while these are determined. Empty if the fit has no `young_modulus`, or E
/// is not known within a factor of 2.
std::optional<EffectiveMaterial> effective_material(const Problem& problem, const Fit& fit,
                                                    const std::string& material,
                                                    const std::array<double, 2>& strain_range);

}  // namespace palpate::fit
