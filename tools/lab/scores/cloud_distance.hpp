#pragma once

#include <Eigen/Core>

#include "sim/draw/solids.hpp"

namespace palpate::scores {

/// Statistics of distances, m.
struct DistanceSummary {
  double mean = 0;
  double rms = 0;
  double maximum = 0;
};

/// `weights`: one per distance, or none for equal ones.
DistanceSummary summarise_distances(const Eigen::VectorXd& distances,
                                    const Eigen::VectorXd& weights = {});

/// Distance of each point, 3 x n, to the nearest of `cloud`, m. Throws std::invalid_argument if the
/// cloud is empty.
Eigen::VectorXd distances_to_cloud(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& cloud);

/// Unsigned exact distance of each point, 3 x n, to the surface, m. Throws std::invalid_argument if
/// the surface has no triangle.
Eigen::VectorXd distances_to_surface(const Eigen::Matrix3Xd& points,
                                     const draw::TriangleMesh& surface);

/// Points distributed over a surface: the centroids of equal parts of each triangle, none with a
/// side above `spacing`, weighted by their area, and then the corners with weight 0. No point of
/// the surface is farther than 2/3 `spacing` from a sample. If that would give more than half a
/// million samples, the spacing is increased. Throws std::invalid_argument if a point is not
/// finite.
struct SurfaceSamples {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd weights;  // m^2
};
SurfaceSamples sample_surface(const draw::TriangleMesh& surface, double spacing);

/// Distance between two surfaces.
struct SurfaceDistance {
  DistanceSummary from_first;   // of the first surface's points to the second, by area
  DistanceSummary from_second;  // of the second's to the first
  double hausdorff = 0;  // m, the larger maximum; underestimated by at most 2/3 of the spacing
};
SurfaceDistance surface_distance(const draw::TriangleMesh& first, const draw::TriangleMesh& second,
                                 double spacing);

}  // namespace palpate::scores
