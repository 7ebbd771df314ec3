#pragma once

#include <memory>
#include <vector>

#include "core/mesh/point_locator.hpp"
#include "core/solid/solid_solver.hpp"

namespace palpate::fit {

/// A marker on a stalk that stays perpendicular to the surface of a box of quadratic elements.
class SurfaceMarker {
 public:
  /// Located at `place` off the box from `corner` to `corner` + `size` that the locator's mesh
  /// fills, on the closest point of the surface (or on the face from which it is farthest).
  SurfaceMarker(const mesh::PointLocator& locator, const Eigen::Vector3d& corner,
                const Eigen::Vector3d& size, const Eigen::Vector3d& place);

  Eigen::Vector3d position(const Eigen::Matrix3Xd& x) const;
  /// Derivative of position() for displacements dx of the nodes at x.
  Eigen::Vector3d slope(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& dx) const;

 private:
  /// Vector between two points of the material.
  struct Span {
    mesh::PointWeights ahead, behind;
    Eigen::Vector3d of(const Eigen::Matrix3Xd& x) const {
      return ahead.interpolate(x) - behind.interpolate(x);
    }
  };

  mesh::PointWeights foot_;
  Span first_, second_;  // along the surface
  double stand_ = 0;     // m, along first x second
};

/// Geometry and load of a beam. Frame O of the recording: x along the beam, z up, weight along -z.
struct BeamShape {
  Eigen::Vector3d corner;    // m, smallest coordinates; the face x = corner.x is clamped
  Eigen::Vector3d size;      // m
  std::array<int, 3> cells;  // of the mesh
  double tip_mass = 0;       // kg, distributed along the upper edge of the free end
  std::vector<Eigen::Vector3d> markers;        // m, on or off the beam's surface
  std::vector<Eigen::Vector3d> clamp_markers;  // m, fixed to the clamp
};

/// Parameters of a beam, by index of a parameter vector.
enum BeamParameter {
  kYoung,                  // Pa
  kPoisson,                //
  kDensity,                // kg/m^3
  kMassDamping,            // 1/s, Rayleigh
  kStiffnessDamping,       // s, Rayleigh
  kTilt,                   // rad, 3: rotation vector of the clamp about the centre of its face
  kOffset = kTilt + 3,     // m, 3: of the clamp
  kRelease = kOffset + 3,  // s, time of the release
  kHeldSag,                // fraction of its loads that bends it while it is held
  kBeamParameters,
};
using BeamVector = Eigen::Matrix<double, kBeamParameters, 1>;

/// Values with their derivatives by the parameters, one row each.
struct BeamPrediction {
  Eigen::VectorXd values;
  Eigen::Matrix<double, Eigen::Dynamic, kBeamParameters> slopes;
};

/// Large deflection of a clamped Neo-Hookean beam by finite elements (core/elasticity/solid_*), at
/// rest and after its release. A tilt of the clamp is computed as one of gravity's direction.
/// Constant after construction: threads may share it.
class BeamModel {
 public:
  /// Throws std::invalid_argument.
  explicit BeamModel(BeamShape shape);

  int node_count() const { return body_->mesh().node_count(); }

  /// Displacements at rest (m, x y z by marker, the beam's first), relative to the marker positions
  /// on the straight beam with the clamp neither tilted nor shifted. False without equilibrium.
  bool at_rest(const BeamVector& parameters, BeamPrediction& prediction) const;

  /// Mean height (m) of the beam's markers above that of the straight beam at `times` (s,
  /// ascending), released at rest at time kRelease, from the shape bent by the fraction kHeldSag of
  /// its loads (0: straight). Steps of `step` s. False if a step fails.
  bool swing(const BeamVector& parameters, const Eigen::VectorXd& times, double step,
             BeamPrediction& prediction) const;

 private:
  struct Clamp;
  std::vector<solid::SolidSlope> slopes(const BeamVector& parameters, const Clamp& clamp) const;
  /// Of a marker at p of the untilted beam; dp by parameter.
  void place(const Clamp& clamp, const Eigen::Vector3d& p,
             const Eigen::Matrix<double, 3, kBeamParameters>& dp, Eigen::Vector3d& displaced,
             Eigen::Matrix<double, 3, kBeamParameters>& slope) const;

  BeamShape shape_;
  std::unique_ptr<const solid::SolidBody> body_;
  Eigen::VectorXd nodal_mass_;  // kg, of the tip's
  std::vector<SurfaceMarker> markers_;
};

}  // namespace palpate::fit
