#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/fit/fit.hpp"

namespace palpate::fit {

/// The linear co-rotational material that comes closest to what was fitted.
struct EffectiveMaterial {
  double young_modulus = 0;  // Pa
  double poisson_ratio = 0;
  std::array<double, 2> modulus_interval{};  // 95 %; both the value where none is known
  std::array<double, 2> poisson_interval{};
  std::array<double, 2> strain_range{};  // that it holds for
};

/// Greatest Poisson's ratio of the co-rotational model: its elements lock beyond.
inline constexpr double kGreatestEffectivePoisson = 0.49;

/// E is the slope through the origin with the least squared stress error over `strain_range` of a
/// bar with free sides, nu that of its lateral strain (small strain's where the volume is kept), at
/// most kGreatestEffectivePoisson; of a `linear` material its own. Intervals by the delta method,
/// what the data leave open included as far as it may go: constants may be open and these still
/// told. Nothing where the fit has no `young_modulus`, or E is not known within a factor of 2.
std::optional<EffectiveMaterial> effective_material(const Problem& problem, const Fit& fit,
                                                    const std::string& material,
                                                    const std::array<double, 2>& strain_range);

}  // namespace palpate::fit
