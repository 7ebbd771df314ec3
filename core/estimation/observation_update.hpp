#pragma once

#include "core/estimation/wrench_update.hpp"

namespace palpate::estimation {

/// Update of the fused state by observed points on the surface of the object. They correct the
/// states of the wrench update and also virtual loads, which absorb errors of the model's shape.
/// Corrections are faded into the shape, which therefore never jumps. Active from the first message
/// on. Nothing allocates after construction.
class ObservationUpdate {
 public:
  struct Options {
    SurfaceFit::Options observation;
    /// m, prior standard deviation of the displacement by each virtual load. A smaller value gives
    /// a smaller error if the camera's own errors are uniform, but intervals that are too narrow:
    /// at 1 mm the 95 % intervals contain 83 % of the true positions.
    double shape = 5e-3;
    /// s, time over which corrections from observations are faded into the shape
    double fade = 0.15;
  };

  /// Throws std::invalid_argument if an option of the surface fit is out of range.
  ObservationUpdate(const elasticity::Body& body, const mesh::Surface& surface,
                    const Options& options);

  void reset() noexcept;
  /// Whether observations were received; the model then has the virtual loads configured.
  bool is_active() const noexcept { return is_active_; }
  /// Adds the virtual loads, N, that the shape follows at present.
  void add_loads(const FusedState& state, Eigen::Matrix3Xd& loads) const noexcept;
  /// Call once per tick. The shape history is recorded from the first message on, so that later
  /// messages find the shape at their acquisition time.
  void update(const ObservationInput& seen, FusedState& state, WrenchUpdate& wrenches,
              elasticity::DeformationModel& model, double dt) noexcept;

 private:
  void correct(FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) const noexcept;

  Options options_;
  VirtualLoads loads_;
  SurfaceFit fit_;
  ShapeHistory history_;
  bool is_active_ = false;
};

}  // namespace palpate::estimation
