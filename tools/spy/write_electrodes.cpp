// Writes the positions of the electrodes on the unrolled skin, for the spy's map: u, v in mm, one
// per line. u runs along the finger towards the tip, v around it.

#include <cmath>
#include <cstdio>

#include "core/sensing/biotac_geometry.hpp"

int main() {
  using namespace palpate::sensing;
  std::printf("# u_mm,v_mm of E1 to E19; made from core/sensing/biotac_geometry\n");
  for (int i = 0; i < kElectrodeCount; ++i) {
    const Eigen::Vector3d position = electrode_positions().col(i);
    // Along the radius to the skin: a cylinder up to the tip's sphere, on which circles of latitude
    // shrink.
    const double from_axis = std::hypot(position.y(), position.z());
    const double latitude = std::atan2(std::fmax(position.x(), 0), from_axis);
    const double around = std::atan2(position.y(), -position.z());
    const double u = std::fmin(position.x(), 0) + kSkinRadius * latitude;
    const double v = kSkinRadius * std::cos(latitude) * around;
    std::printf("%.4f,%.4f\n", 1e3 * u, 1e3 * v);
  }
  return 0;
}
