#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::sensing {

inline constexpr int kElectrodeCount = 19;
using ElectrodeVector = Eigen::Matrix<double, kElectrodeCount, 1>;

/// Radius of the skin, m: a cylinder about x for x < 0, a sphere about the origin otherwise (Lin,
/// Fishel and Loeb 2013, eq. 2). Frame T: x points to the tip, z out of the nail, the skin is at
/// -z.
inline constexpr double kSkinRadius = 7e-3;

/// Centres (m) and outward normals of the sensing electrodes E1 to E19 in T (Lin et al. 2013).
const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_positions() noexcept;
const Eigen::Matrix<double, 3, kElectrodeCount>& electrode_normals() noexcept;

/// Radial projection of `p` (m, in T) onto the skin.
Eigen::Vector3d project_on_skin(const Eigen::Vector3d& p) noexcept;

/// Outward normal of the skin at a point on it.
Eigen::Vector3d skin_normal(const Eigen::Vector3d& p) noexcept;

inline constexpr int kAreaCount = 9;

/// Centres (m, in T, on the core) of the contact areas 1 to 9, one column each (Lin et al. 2013): 1
/// to 3 along the midline towards the tip; 4, 6 and 8 next to them at y < 0; 5, 7 and 9 at y > 0.
const Eigen::Matrix<double, 3, kAreaCount>& area_centres() noexcept;

/// Number, 1 to 9, of the area whose centre is nearest to a location on the skin (m, in T),
/// measured between points of the skin.
int nearest_area(const Eigen::Vector3d& location) noexcept;

enum class Weighting {
  /// Sanchez 2019, section 3.2: the intensity-weighted sum is divided by the number of electrodes
  kPublished,
  kCentroid,  // centroid weighted by the intensities
};

struct LocalizationOptions {
  /// 1: counts increase under pressure; -1: they decrease. Both kinds of sensor exist.
  double polarity = 1;
  double threshold = 5;     // counts above which an electrode is active
  double saturation = 100;  // counts of full intensity
  Weighting weighting = Weighting::kCentroid;
};

struct Localization {
  /// Number of active electrodes; 0: no contact located.
  int active = 0;
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m, on the skin, in T
};

/// Pressure intensity of an electrode, 0 to 1; negative if it is not active.
double electrode_intensity(double counts, const LocalizationOptions& options) noexcept;

/// Contact location from tared electrode counts: active electrodes, their intensities, centroid,
/// projection onto the skin (Sanchez 2019, Fig. 3.10).
Localization locate_contact(const ElectrodeVector& counts,
                            const LocalizationOptions& options) noexcept;
/// The same with electrode centres at `positions` (m, in T).
Localization locate_contact(const ElectrodeVector& counts, const LocalizationOptions& options,
                            const Eigen::Matrix<double, 3, kElectrodeCount>& positions) noexcept;

}  // namespace palpate::sensing
