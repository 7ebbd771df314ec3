#pragma once

#include <Eigen/Core>

#include "core/math/random.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/view.hpp"

namespace palpate::camera {

/// How a structured-light camera such as the first Kinect errs. Axial and lateral noise by distance
/// z and angle theta between surface normal and line of sight: Nguyen, Izadi and Lovell 2012,
/// "Modeling Kinect sensor noise for improved 3D reconstruction and tracking", eqs. 1 to 3. Steps
/// of disparity and range: Khoshelham and Elberink 2012, "Accuracy and resolution of Kinect depth
/// data for indoor mapping applications", Sensors 12(2). How much is lost at edges is our choice.
/// Noise of neighbouring pixels is independent, while a real camera correlates it over some pixels.
struct DepthNoiseOptions {
  double scale = 1;               // on axial and lateral noise; 0: none
  double disparity_step = 0.125;  // px; 0: none
  double base = 0.075;            // m, between projector and camera
  double edge_loss = 0.5;         // probability that a pixel beside a jump in depth has no depth
  double most_angle = 1.4;        // rad; surfaces seen at more from their normal have no depth
  double nearest = 0.5;           // m, nor has anything nearer
  double farthest = 5;            // m, nor farther
};

/// Standard deviation along the optical axis, m, at distance `z` (m) and `angle` (rad).
double axial_noise(double z, double angle);

/// Standard deviation of where in the picture an edge is seen, px.
double lateral_noise(double angle);

/// Adds noise to depth images.
class DepthNoise {
 public:
  /// Throws std::invalid_argument where an option is out of range.
  DepthNoise(const DepthNoiseOptions& options, const draw::Intrinsics& intrinsics);

  /// `truth`: without noise. The picture that the camera gives; all chance comes from `random`.
  draw::DepthImage apply(const draw::DepthImage& truth, math::Random random) const;

  /// Standard deviation along the optical axis of a surface that is seen from the front, m:
  /// noise and steps.
  double deviation(double z) const;

 private:
  struct Surroundings {
    double angle = 0;       // rad, between normal and line of sight
    bool at_jump = false;   // one of the four neighbours belongs to another surface
    bool has_slope = true;  // not so on what is one pixel wide, or seen from its side
  };
  Surroundings look_around(const draw::DepthImage& truth, int column, int row) const;
  bool jumps(double z, double other) const;
  double displaced(const draw::DepthImage& truth, int column, int row, double angle,
                   math::Random& random) const;
  double quantised(double z) const;

  DepthNoiseOptions options_;
  draw::Intrinsics intrinsics_;
  double steepest_;  // change of depth by depth from pixel to pixel that is still one surface
};

}  // namespace palpate::camera
