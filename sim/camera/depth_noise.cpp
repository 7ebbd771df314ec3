#include "sim/camera/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"

namespace palpate::camera {
namespace {

using math::kPi;
constexpr double kSteep = kPi / 3;  // angle above which it adds to the axial noise

/// Tends to infinity for a surface seen edge-on.
double steepness(double angle) { return angle / (kPi / 2 - angle); }

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("depth noise: ") + what);
}

}  // namespace

double axial_noise(double z, double angle) {
  const double frontal = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
  if (angle <= kSteep) return frontal;
  return frontal + 0.0001 / std::sqrt(z) * steepness(angle) * steepness(angle);
}

double lateral_noise(double angle) { return 0.8 + 0.035 * steepness(angle); }

DepthNoise::DepthNoise(const DepthNoiseOptions& options, const draw::Intrinsics& intrinsics)
    : options_(options),
      intrinsics_(intrinsics),
      steepest_(std::tan(options.most_angle) / std::min(intrinsics.fx, intrinsics.fy)) {
  require(options.scale >= 0, "the scale must not be negative");
  require(options.disparity_step >= 0, "the step of disparity must not be negative");
  require(options.base > 0, "the base must be positive");
  require(options.edge_loss >= 0 && options.edge_loss <= 1, "the loss at edges is a probability");
  require(options.most_angle > 0 && options.most_angle < kPi / 2,
          "the largest angle must lie between 0 and a right angle");
  require(options.nearest >= 0 && options.farthest > options.nearest,
          "needs 0 <= nearest < farthest");
}

bool DepthNoise::jumps(double z, double other) const {
  return other == 0 || std::abs(z - other) > steepest_ * std::min(z, other);
}

DepthNoise::Surroundings DepthNoise::look_around(const draw::DepthImage& truth, int column,
                                                 int row) const {
  Surroundings around;
  const double z = truth.at(column, row);
  double slope[2] = {0, 0};  // of depth by column and row, on the side where it is smaller
  for (int axis = 0; axis < 2; ++axis) {
    bool known = false;
    for (const int side : {-1, 1}) {
      const int c = column + (axis == 0 ? side : 0);
      const int r = row + (axis == 1 ? side : 0);
      if (c < 0 || r < 0 || c >= truth.width || r >= truth.height) continue;
      const double other = truth.at(c, r);
      if (jumps(z, other)) {
        around.at_jump = true;
        continue;
      }
      const double change = side * (other - z);
      if (!known || std::abs(change) < std::abs(slope[axis])) slope[axis] = change;
      known = true;
    }
    around.has_slope = around.has_slope && known;
  }
  // Tangents of the surface are the derivatives of z(column, row) times the ray through the pixel.
  const Eigen::Vector3d ray((column - intrinsics_.cx) / intrinsics_.fx,
                            (row - intrinsics_.cy) / intrinsics_.fy, 1);
  const Eigen::Vector3d along_row = slope[0] * ray + Eigen::Vector3d(z / intrinsics_.fx, 0, 0);
  const Eigen::Vector3d along_column = slope[1] * ray + Eigen::Vector3d(0, z / intrinsics_.fy, 0);
  const Eigen::Vector3d normal = along_row.cross(along_column);
  around.angle = std::acos(std::min(1.0, normal.dot(ray) / (normal.norm() * ray.norm())));
  return around;
}

/// Lateral noise moves edges. Within a surface the pixel keeps its own depth: the effect of the
/// shift on a slope is already part of the measured axial noise.
double DepthNoise::displaced(const draw::DepthImage& truth, int column, int row, double angle,
                             math::Random& random) const {
  const double deviation = options_.scale * lateral_noise(angle);
  const int c = column + static_cast<int>(std::lround(deviation * random.normal()));
  const int r = row + static_cast<int>(std::lround(deviation * random.normal()));
  const double z = truth.at(column, row);
  if (c < 0 || r < 0 || c >= truth.width || r >= truth.height) return z;
  // A distant pixel of the same slope is not an edge: the largest change grows with the distance.
  const double other = truth.at(c, r);
  const int steps = std::abs(c - column) + std::abs(r - row);
  const bool edge = other == 0 || std::abs(z - other) > steps * steepest_ * std::min(z, other);
  return edge ? other : z;
}

double DepthNoise::quantised(double z) const {
  if (options_.disparity_step <= 0) return z;
  const double disparity = options_.base * intrinsics_.fx / z;
  const double counts = std::round(disparity / options_.disparity_step);
  return counts > 0 ? options_.base * intrinsics_.fx / (counts * options_.disparity_step) : 0;
}

draw::DepthImage DepthNoise::apply(const draw::DepthImage& truth, math::Random random) const {
  draw::DepthImage measured{truth.width, truth.height, std::vector<float>(truth.metres.size())};
  for (int row = 0; row < truth.height; ++row) {
    for (int column = 0; column < truth.width; ++column) {
      if (truth.at(column, row) == 0) continue;
      const Surroundings around = look_around(truth, column, row);
      const bool lost = around.at_jump && random.uniform() < options_.edge_loss;
      if (lost || !around.has_slope || around.angle > options_.most_angle) continue;
      double z = truth.at(column, row);
      if (options_.scale > 0) {
        z = displaced(truth, column, row, around.angle, random);
        if (z == 0) continue;
        z += options_.scale * axial_noise(z, around.angle) * random.normal();
      }
      z = quantised(z);
      if (!(z >= options_.nearest && z <= options_.farthest)) continue;
      measured.metres[std::size_t(row) * truth.width + column] = static_cast<float>(z);
    }
  }
  return measured;
}

double DepthNoise::deviation(double z) const {
  const double step = options_.disparity_step * z * z / (options_.base * intrinsics_.fx);
  return std::hypot(options_.scale * axial_noise(z, 0), step / std::sqrt(12.0));
}

}  // namespace palpate::camera
