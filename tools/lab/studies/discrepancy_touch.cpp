#include "tools/lab/studies/discrepancy_touch.hpp"

#include <cmath>
#include <vector>

#include "tools/log/plant_truth.hpp"

namespace palpate::studies {
namespace {

constexpr double kTouch = 0.3e-3;      // m, between the surface and an obstacle in contact
constexpr double kGridSpacing = 4e-3;  // m; between two points a cylinder of 20 mm rises by 0.1 mm

/// Points on the faces of the plant's box at rest, 3 x n.
Eigen::Matrix3Xd surface_points(const log::MeshMessage& plant) {
  const Eigen::Vector3d lower = plant.nodes.rowwise().minCoeff(),
                        size = plant.nodes.rowwise().maxCoeff() - lower;
  const Eigen::Vector3i cells = (size / kGridSpacing).array().ceil().max(1).matrix().cast<int>();
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {0, 1})
      for (int i = 0; i <= cells[u]; ++i)
        for (int j = 0; j <= cells[v]; ++j) {
          Eigen::Vector3d place;
          place[axis] = side;
          place[u] = static_cast<double>(i) / cells[u];
          place[v] = static_cast<double>(j) / cells[v];
          points.emplace_back(lower + size.cwiseProduct(place));
        }
  }
  return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3,
                                            static_cast<Eigen::Index>(points.size()));
}

bool touches(const Eigen::Matrix3Xd& points, const RigidObstacle& obstacle) {
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (obstacle.distance(points.col(i)) < kTouch) return true;
  return false;
}

}  // namespace

std::optional<TouchTimes> find_touch(const log::RunLog& log, const RigidObstacle& obstacle) {
  const log::MeshMessage plant = log::assemble(log.truth_chunks);
  const log::PlantPoints surface(plant, surface_points(plant));
  std::optional<TouchTimes> times;
  for (const shape_t& truth : log.truths) {
    const Eigen::Matrix3Xd nodes = log::positions(truth);
    if (nodes.cols() != plant.nodes.cols() || !touches(surface.at(nodes), obstacle)) continue;
    if (!times) times = TouchTimes{truth.utime, truth.utime};
    times->last = truth.utime;
  }
  return times;
}

}  // namespace palpate::studies
