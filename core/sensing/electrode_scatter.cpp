#include "core/sensing/electrode_scatter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::sensing {

Eigen::Matrix<double, 3, kElectrodeCount> scatter_electrodes(const ElectrodeVector& counts,
                                                             const LocalizationOptions& options,
                                                             ElectrodeScatter scatter,
                                                             math::Random& random) noexcept {
  Eigen::Matrix<double, 3, kElectrodeCount> positions = electrode_positions();
  if (scatter == ElectrodeScatter::kNominal) return positions;
  for (int i = 0; i < kElectrodeCount; ++i) {
    const double along_u = random.normal();
    const double along_v = random.normal();
    double intensity = std::max(electrode_intensity(counts[i], options), 0.0);
    if (scatter == ElectrodeScatter::kInvertedGaussian) intensity = 1 - intensity;
    const double deviation = 1e-3 * std::sqrt(0.1 + 0.9 * intensity);
    const Eigen::Vector3d n = electrode_normals().col(i).normalized();
    const Eigen::Vector3d u = n.unitOrthogonal();
    positions.col(i) += deviation * (along_u * u + along_v * u.cross(n));
  }
  return positions;
}

}  // namespace palpate::sensing
