#include "tools/lab/scores/truth_points.hpp"

namespace palpate::scores {
namespace {

using Eigen::Array3d;

constexpr double kSame = 1e-6;    // of a side: coordinates are sent as 32-bit numbers
constexpr double kAnother = 0.1;  // of a side: not the same object

}  // namespace

Eigen::Matrix3Xd corresponding_points(const log::MeshMessage& plant,
                                      const log::MeshMessage& estimate,
                                      const Eigen::Matrix3Xd& rest_points) {
  const Array3d from = estimate.nodes.rowwise().minCoeff(), to = plant.nodes.rowwise().minCoeff();
  const Array3d side = estimate.nodes.rowwise().maxCoeff().array() - from,
                true_side = plant.nodes.rowwise().maxCoeff().array() - to;
  if (!(side > 0).all()) return rest_points;
  const Array3d scale = true_side / side;
  const double most = (scale - 1).abs().maxCoeff();
  if (most < kSame || most > kAnother) return rest_points;
  return (((rest_points.array().colwise() - from).colwise() * scale).colwise() + to).matrix();
}

TruthPoints::TruthPoints(const log::MeshMessage& plant, const log::MeshMessage& estimate,
                         const Eigen::Matrix3Xd& rest_points, const math::Pose& X_OP)
    : points_(plant, corresponding_points(plant, estimate, rest_points)), X_OP_(X_OP) {}

Eigen::Matrix3Xd TruthPoints::at(const Eigen::Matrix3Xd& plant_positions) const {
  return log::transformed(X_OP_, points_.at(plant_positions));
}

}  // namespace palpate::scores
