#include "tools/lab/scores/cloud_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <stdexcept>
#include <vector>

#include "core/mesh/closest_point.hpp"

namespace palpate::scores {
namespace {

constexpr bool kRowMajor = false;  // one point per column
using Tree = nanoflann::KDTreeEigenMatrixAdaptor<Eigen::Matrix3Xd, 3, nanoflann::metric_L2_Simple,
                                                 kRowMajor>;

/// Triangles by their centroids. A triangle within some distance of a point has its centroid within
/// that distance plus its own radius.
class SurfaceTree {
 public:
  explicit SurfaceTree(const draw::TriangleMesh& surface)
      : surface_(surface), middles_(middles_of(surface)), tree_(3, middles_) {
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t)
      for (const int corner : surface.triangles.col(t))
        reach_ = std::max(reach_, (surface.points.col(corner) - middles_.col(t)).norm());
  }

  double distance(const Eigen::Vector3d& point) const {
    Eigen::Index first = 0;
    double squared = 0;
    tree_.query(point.data(), 1, &first, &squared);
    double nearest = distance_to(first, point);
    const double radius = nearest + reach_;
    tree_.index->radiusSearch(point.data(), radius * radius * (1 + 1e-9), found_,
                              nanoflann::SearchParams(32, 0, true));
    for (const auto& [triangle, distance_squared] : found_) {
      if (std::sqrt(distance_squared) > nearest + reach_) break;  // they are visited in this order
      nearest = std::min(nearest, distance_to(triangle, point));
    }
    return nearest;
  }

 private:
  static Eigen::Matrix3Xd middles_of(const draw::TriangleMesh& surface) {
    Eigen::Matrix3Xd middles(3, surface.triangles.cols());
    for (Eigen::Index t = 0; t < middles.cols(); ++t)
      middles.col(t) = surface.points(Eigen::all, surface.triangles.col(t)).rowwise().mean();
    return middles;
  }

  double distance_to(Eigen::Index triangle, const Eigen::Vector3d& point) const {
    const auto corners = surface_.triangles.col(triangle);
    return mesh::closest_point_on_triangle(point, surface_.points.col(corners[0]),
                                           surface_.points.col(corners[1]),
                                           surface_.points.col(corners[2]))
        .distance;
  }

  const draw::TriangleMesh& surface_;
  Eigen::Matrix3Xd middles_;
  Tree tree_;
  double reach_ = 0;
  mutable std::vector<std::pair<Eigen::Index, double>> found_;
};

double longest_side(const draw::TriangleMesh& surface, Eigen::Index triangle) {
  const auto corners = surface.triangles.col(triangle);
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(
        longest,
        (surface.points.col(corners[i]) - surface.points.col(corners[(i + 1) % 3])).norm());
  return longest;
}

/// A diverged estimate is metres wide: fewer samples suffice to show its error.
double affordable_spacing(const draw::TriangleMesh& surface, double spacing) {
  constexpr double kMost = 5e5;
  double count = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const double parts = longest_side(surface, t) / spacing;
    count += parts * parts;
  }
  if (!surface.points.allFinite() || !std::isfinite(count))
    throw std::invalid_argument("a surface has points that are not finite");
  return spacing * std::max(1.0, std::sqrt(count / kMost));
}

}  // namespace

DistanceSummary summarise_distances(const Eigen::VectorXd& distances,
                                    const Eigen::VectorXd& weights) {
  if (distances.size() == 0) return {};
  const Eigen::VectorXd equal =
      weights.size() == 0 ? Eigen::VectorXd::Ones(distances.size()) : weights;
  const double whole = equal.sum();
  return {equal.dot(distances) / whole, std::sqrt(equal.dot(distances.cwiseAbs2()) / whole),
          distances.maxCoeff()};
}

Eigen::VectorXd distances_to_cloud(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& cloud) {
  if (cloud.cols() == 0) throw std::invalid_argument("distance to a cloud without points");
  const Tree tree(3, cloud);
  Eigen::VectorXd distances(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::Index nearest = 0;
    double squared = 0;
    tree.query(points.col(i).data(), 1, &nearest, &squared);
    distances[i] = std::sqrt(squared);
  }
  return distances;
}

Eigen::VectorXd distances_to_surface(const Eigen::Matrix3Xd& points,
                                     const draw::TriangleMesh& surface) {
  if (surface.triangles.cols() == 0) throw std::invalid_argument("distance to an empty surface");
  const SurfaceTree tree(surface);
  Eigen::VectorXd distances(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) distances[i] = tree.distance(points.col(i));
  return distances;
}

SurfaceSamples sample_surface(const draw::TriangleMesh& surface, double spacing) {
  if (!(spacing > 0)) throw std::invalid_argument("samples of a surface need a positive spacing");
  spacing = affordable_spacing(surface, spacing);
  std::vector<Eigen::Vector3d> points;
  std::vector<double> weights;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const auto triangle = surface.triangles.col(t);
    const Eigen::Vector3d a = surface.points.col(triangle[0]);
    const Eigen::Vector3d ab = surface.points.col(triangle[1]) - a;
    const Eigen::Vector3d ac = surface.points.col(triangle[2]) - a;
    const int n = std::max(1, static_cast<int>(std::ceil(longest_side(surface, t) / spacing)));
    const double area = 0.5 * ab.cross(ac).norm() / (double(n) * n);
    const auto add = [&](double u, double v) {
      points.push_back(a + (u * ab + v * ac) / n);
      weights.push_back(area);
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < n) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
    for (const int corner : triangle) {
      points.push_back(surface.points.col(corner));
      weights.push_back(0);
    }
  }
  SurfaceSamples samples{Eigen::Matrix3Xd(3, points.size()), Eigen::VectorXd(weights.size())};
  for (std::size_t i = 0; i < points.size(); ++i) {
    samples.points.col(i) = points[i];
    samples.weights[i] = weights[i];
  }
  return samples;
}

SurfaceDistance surface_distance(const draw::TriangleMesh& first, const draw::TriangleMesh& second,
                                 double spacing) {
  const auto one_way = [spacing](const draw::TriangleMesh& from, const draw::TriangleMesh& to) {
    const SurfaceSamples samples = sample_surface(from, spacing);
    return summarise_distances(distances_to_surface(samples.points, to), samples.weights);
  };
  SurfaceDistance distance{one_way(first, second), one_way(second, first), 0};
  distance.hausdorff = std::max(distance.from_first.maximum, distance.from_second.maximum);
  return distance;
}

}  // namespace palpate::scores
