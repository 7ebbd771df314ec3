#include "core/sensing/biotac_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::sensing {
namespace {

struct Electrode {
  double position_mm[3];
  double normal[3];
};

// Lin, Fishel and Loeb 2013, "Estimating point of contact, force and torque in a biomimetic tactile
// sensor with deformable skin"; E1 to E19.
constexpr Electrode kElectrodes[kElectrodeCount] = {
    {{0.993, -4.855, -1.116}, {0.196, -0.956, -0.22}},
    {{-2.7, -3.513, -3.67}, {0, -0.692, -0.722}},
    {{-6.2, -3.513, -3.67}, {0, -0.692, -0.722}},
    {{-8, -4.956, -1.116}, {0, -0.976, -0.22}},
    {{-10.5, -3.513, -3.67}, {0, -0.692, -0.722}},
    {{-13.4, -4.956, -1.116}, {0, -0.976, -0.22}},
    {{4.763, 0, -2.33}, {0.5, 0, -0.866}},
    {{3.031, -1.95, -3.33}, {0.5, 0, -0.866}},
    {{3.031, 1.95, -3.33}, {0.5, 0, -0.866}},
    {{1.299, 0, -4.33}, {0.5, 0, -0.866}},
    {{0.993, 4.855, -1.116}, {0.196, 0.956, -0.22}},
    {{-2.7, 3.513, -3.67}, {0, 0.692, -0.722}},
    {{-6.2, 3.513, -3.67}, {0, 0.692, -0.722}},
    {{-8, 4.956, -1.116}, {0, 0.976, -0.22}},
    {{-10.5, 3.513, -3.67}, {0, 0.692, -0.722}},
    {{-13.4, 4.956, -1.116}, {0, 0.976, -0.22}},
    {{-2.8, 0, -5.08}, {0, 0, -1}},
    {{-9.8, 0, -5.08}, {0, 0, -1}},
    {{-13.6, 0, -5.08}, {0, 0, -1}},
};

Eigen::Matrix<double, 3, kElectrodeCount> table(const double (Electrode::*field)[3], double scale) {
  Eigen::Matrix<double, 3, kElectrodeCount> columns;
  for (int i = 0; i < kElectrodeCount; ++i)
    for (int r = 0; r < 3; ++r) columns(r, i) = scale * (kElectrodes[i].*field)[r];
  return columns;
}

const Eigen::Matrix<double, 3, kElectrodeCount> kPositions = table(&Electrode::position_mm, 1e-3);
const Eigen::Matrix<double, 3, kElectrodeCount> kNormals = table(&Electrode::normal, 1.0);

// The published file gives area 8 the y of area 9; they are mirror images, as are 4 and 5, 6 and 7.
const Eigen::Matrix<double, 3, kAreaCount> kAreas =
    1e-3 * (Eigen::Matrix<double, 3, kAreaCount>() <<  //
                -11.7,
            -6.2, 3, -11.9, -11.9, -6.2, -6.2, 3, 3,       //
            0, 0, 0, -3.513, 3.513, -3.513, 3.513, -3, 3,  //
            -5.08, -5.08, -3.33, -3.5, -3.5, -3.67, -3.67, -2.5, -2.5)
               .finished();

}  // namespace

const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_positions() noexcept {
  return kPositions;
}

const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_normals() noexcept { return kNormals; }

Eigen::Vector3d skin_normal(const Eigen::Vector3d& p) noexcept {
  Eigen::Vector3d radius = p;
  if (p.x() < 0) radius.x() = 0;
  const double length = radius.norm();
  // on the axis the direction is undefined: use the middle of the pad
  if (length < 1e-9) return -Eigen::Vector3d::UnitZ();
  return radius / length;
}

Eigen::Vector3d project_on_skin(const Eigen::Vector3d& p) noexcept {
  return kSkinRadius * skin_normal(p) + std::min(p.x(), 0.0) * Eigen::Vector3d::UnitX();
}

const Eigen::Matrix<double, 3, kAreaCount>& area_centres() noexcept { return kAreas; }

int nearest_area(const Eigen::Vector3d& location) noexcept {
  const Eigen::Vector3d at = project_on_skin(location);
  int nearest = 0;
  double least = 0;
  for (int i = 0; i < kAreaCount; ++i) {
    const double distance = (project_on_skin(kAreas.col(i)) - at).squaredNorm();
    if (nearest > 0 && distance >= least) continue;
    nearest = i + 1;
    least = distance;
  }
  return nearest;
}

double electrode_intensity(double counts, const LocalizationOptions& options) noexcept {
  const double pressed = options.polarity * counts;
  if (!(pressed > options.threshold)) return -1;
  return std::clamp(pressed / options.saturation, 0.0, 1.0);
}

Localization locate_contact(const ElectrodeVector& counts,
                            const LocalizationOptions& options) noexcept {
  return locate_contact(counts, options, kPositions);
}

Localization locate_contact(const ElectrodeVector& counts, const LocalizationOptions& options,
                            const Eigen::Matrix<double, 3, kElectrodeCount>& positions) noexcept {
  Localization result;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  double total = 0;
  for (int i = 0; i < kElectrodeCount; ++i) {
    const double intensity = electrode_intensity(counts[i], options);
    if (intensity < 0) continue;
    ++result.active;
    centroid += positions.col(i);
    weighted += intensity * positions.col(i);
    total += intensity;
  }
  if (result.active == 0) return result;
  centroid /= result.active;
  const Eigen::Vector3d pull = total > 0 ? Eigen::Vector3d(weighted / total - centroid)
                                         : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const double share = options.weighting == Weighting::kPublished ? 1.0 / result.active : 1.0;
  result.location = project_on_skin(centroid + share * pull);
  return result;
}

}  // namespace palpate::sensing
