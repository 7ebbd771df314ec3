#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::sensing {

inline constexpr int kElectrodeCount = 19;
using ElectrodeVector = Eigen::Matrix<double, kElectrodeCount, 1>;

/// Radius of the skin, m: a cylinder about x where x < 0, a sphere about the origin beyond (Lin,
/// Fishel and Loeb 2013, eq. 2). T: x points to the tip, z out of the nail, the skin lies at -z.
inline constexpr double kSkinRadius = 7e-3;

/// Centres (m) and outward normals of the sensing electrodes E1 to E19 in T (Lin et al. 2013).
const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_positions() noexcept;
const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_normals() noexcept;

/// Point of the skin below `p` (m, in T), along the radius.
Eigen::Vector3d project_on_skin(const Eigen::Vector3d& p) noexcept;

/// Outward normal of the skin at a point of it.
Eigen::Vector3d skin_normal(const Eigen::Vector3d& p) noexcept;

inline constexpr int kAreaCount = 9;

/// Centres (m, in T, on the core) of the contact areas 1 to 9, a column each (Lin et al. 2013): 1
/// to 3 along the middle towards the tip, 4, 6 and 8 beside them at y < 0, 5, 7 and 9 at y > 0.
const Eigen::Matrix<double, 3, kAreaCount>& area_centres() noexcept;

/// Number, 1 to 9, of the area whose centre is nearest to a place of the skin (m, in T), measured
/// between points of the skin.
int nearest_area(const Eigen::Vector3d& location) noexcept;

enum class Weighting {
  kPublished,  // thesis 3.2: the pull of the intensities is divided by the number of electrodes
  kCentroid,   // centroid weighted by the intensities
};

struct LocalizationOptions {
  double polarity = 1;      // 1: counts rise under pressure; -1: they fall. Both kinds exist.
  double threshold = 5;     // counts: an electrode is active beyond it
  double saturation = 100;  // counts that make full intensity
  Weighting weighting = Weighting::kCentroid;
};

struct Localization {
  int active = 0;                                      // electrodes; 0: nothing was found
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m, on the skin, in T
};

/// How strongly an electrode is pressed, 0 to 1; below 0 where it is not active.
double electrode_intensity(double counts, const LocalizationOptions& options) noexcept;

/// Contact location from tared electrode counts: active electrodes, their intensities, centroid,
/// projection on the skin (thesis Fig. 3.10).
Localization locate_contact(const ElectrodeVector& counts,
                            const LocalizationOptions& options) noexcept;
/// The same with the electrodes' centres at `positions` (m, in T).
Localization locate_contact(const ElectrodeVector& counts, const LocalizationOptions& options,
                            const Eigen::Matrix<double, 3, kElectrodeCount>& positions) noexcept;

}  // namespace palpate::sensing
