#pragma once

#include <array>
#include <vector>

#include "core/elasticity/corotational_model.hpp"
#include "tools/lab/shapes/pushed_sponge.hpp"

namespace palpate::shapes {

/// What a recording does not state; it has no scale either, so that lengths are those of a pixel
/// of kPixel and a sponge of kThickness.
inline constexpr double kPixel = 0.25e-3;      // m, estimated from the rod and the sensor
inline constexpr double kThickness = 30e-3;    // m; only modulus times thickness matters
inline constexpr double kFingerRadius = 29.5;  // pixels
inline constexpr double kFriction = 0.5;       // of finger and table

struct SpongeParameters {
  double poisson_ratio = 0.1;
  double contact_height = 0;  // pixels, y of the finger's centre when it touches the sponge
};

/// Predicted frame.
struct PredictedSponge {
  Eigen::Matrix2Xd outline;  // pixels, y downward, a closed line of the face toward the camera
  double force = 0;          // N, of the finger on the sponge, downward
};

/// Incremental model of a sponge that rests on a table without any clamp while a finger pushes it:
/// the co-rotational dynamic model with two obstacles, one of which moves as recorded.
class SpongeModel {
 public:
  /// `sponge` must outlive this object. `cells`: of the mesh along length and height.
  SpongeModel(const PushedSponge& sponge, std::array<int, 2> cells);

  /// Frames 0 to `last` of the recording with a modulus of kModulus, to which the forces are
  /// proportional but for the weight. Throws std::runtime_error if the model fails.
  std::vector<PredictedSponge> predict(const SpongeParameters& parameters, int last) const;
  static constexpr double kModulus = 4e3;  // Pa

  int nodes() const { return static_cast<int>(mesh_.nodes.cols()); }

 private:
  PredictedSponge observe(const elasticity::CorotationalModel& model) const;

  const PushedSponge& sponge_;
  mesh::ElementMesh mesh_;
  std::vector<int> border_;  // nodes of the outline, in order
};

}  // namespace palpate::shapes
