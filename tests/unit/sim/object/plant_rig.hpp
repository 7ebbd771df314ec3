#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/object/hyperelastic_plant.hpp"
#include "tests/support/plant_momentum.hpp"

namespace palpate::object {

/// Equal elements.
inline HexahedralGrid even_grid(const Eigen::Vector3d& origin, const Eigen::Vector3d& size,
                                const std::array<int, 3>& elements) {
  HexahedralGrid::Borders borders;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i <= elements[axis]; ++i)
      borders[axis].push_back(i * (size[axis] / elements[axis]));
    borders[axis].back() = size[axis];
  }
  return {origin, borders};
}

inline Box face_x(double x) { return {{x, -1, -1}, {x, 1, 1}}; }

inline GraspOptions hold(const Box& patch, const math::Pose& X_OG = math::Pose::Identity()) {
  GraspOptions grasp;
  grasp.patch = patch;
  grasp.X_OG_rest = X_OG;
  return grasp;
}

inline PlantOptions small_free_block() {
  PlantOptions options;
  options.size = {0.10, 0.06, 0.05};
  options.elements = {2, 1, 1};
  options.mass_damping = 0;
  return options;
}

/// A free block pulled along x by uniform tractions on both ends.
class TensionRig {
 public:
  explicit TensionRig(const PlantOptions& options)
      : plant(options), length_(options.size.x()), area_(options.size.y() * options.size.z()) {
    const HexahedralGrid grid = even_grid(options.origin, options.size, options.elements);
    near_ = grid.patch_areas(face_x(0));
    far_ = grid.patch_areas(face_x(length_));
  }

  /// Replaces the load by this nominal stress, Pa.
  void pull(double stress) {
    plant.clear_forces();
    for (int n = 0; n < near_.size(); ++n) {
      const double force = stress * (far_[n] - near_[n]);
      if (force != 0) plant.add_force(plant.locate(plant.rest_positions().col(n)), {force, 0, 0});
    }
  }

  void run(double seconds) {
    for (int i = 0; i < std::lround(1e3 * seconds); ++i) plant.step(1e-3);
  }

  /// Changes the load linearly.
  void ramp(double from, double to, double seconds) {
    const int steps = static_cast<int>(std::lround(1e3 * seconds));
    for (int i = 1; i <= steps; ++i) {
      pull(from + (to - from) * i / steps);
      plant.step(1e-3);
    }
  }

  double strain() const {
    const double far = far_.dot(plant.positions().row(0)),
                 near = near_.dot(plant.positions().row(0));
    return (far - near) / area_ / length_ - 1;
  }

  HyperelasticPlant plant;

 private:
  double length_;
  double area_;
  Eigen::VectorXd near_;  // m^2 by node
  Eigen::VectorXd far_;
};

}  // namespace palpate::object
