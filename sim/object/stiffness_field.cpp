#include "sim/object/stiffness_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "core/math/random.hpp"

namespace palpate::object {
namespace {

constexpr int kWaves = 512;

}  // namespace

StiffnessField::StiffnessField(const StiffnessFieldOptions& options)
    : deviation_(options.deviation) {
  if (!(options.deviation >= 0) || !std::isfinite(options.deviation) || !(options.length > 0)) {
    throw std::invalid_argument("plant: a stiffness field needs deviation >= 0 and length > 0");
  }
  math::Random random(options.seed, "stiffness field");
  for (int i = 0; i < kWaves; ++i) {
    Wave wave;
    for (double& k : wave.vector) k = random.normal() / options.length;
    wave.phase = random.uniform(0, 2 * math::kPi);
    waves_.push_back(wave);
  }
}

double StiffnessField::factor(const Eigen::Vector3d& p_O) const {
  double sum = 0;
  for (const Wave& wave : waves_) sum += std::cos(wave.vector.dot(p_O) + wave.phase);
  const double g = std::sqrt(2.0 / kWaves) * sum;
  return std::exp(deviation_ * std::clamp(g, -kMostDeviations, kMostDeviations));
}

}  // namespace palpate::object
