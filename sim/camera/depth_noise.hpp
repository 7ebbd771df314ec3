#pragma once

#include <Eigen/Core>

#include "core/math/random.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/view.hpp"

namespace palpate::camera {

/// Error model of a structured-light camera such as the first Kinect. Axial and lateral noise by
/// distance z and angle theta between surface normal and viewing ray: Nguyen, Izadi and Lovell
/// 2012, "Modeling Kinect sensor noise for improved 3D reconstruction and tracking", eqs. 1 to 3.
/// Disparity steps and range: Khoshelham and Elberink 2012, "Accuracy and resolution of Kinect
/// depth data for indoor mapping applications", Sensors 12(2). The loss at edges is our choice. The
/// noise of neighbouring pixels is independent, while a real camera correlates it over a few
/// pixels.
struct DepthNoiseOptions {
  double scale = 1;               // factor on axial and lateral noise; 0: none
  double disparity_step = 0.125;  // px; 0: none
  double base = 0.075;            // m, between projector and camera
  double edge_loss = 0.5;         // probability that a pixel next to a jump in depth has no depth
  double most_angle = 1.4;  // rad; surfaces seen at a larger angle to their normal have no depth
  double nearest = 0.5;     // m, no depth below
  double farthest = 5;      // m, no depth beyond
};

/// Standard deviation along the optical axis, m, at distance `z` (m) and `angle` (rad).
double axial_noise(double z, double angle);

/// Standard deviation of an edge's position in the image, px.
double lateral_noise(double angle);

/// Adds noise to depth images.
class DepthNoise {
 public:
  /// Throws std::invalid_argument if an option is out of range.
  DepthNoise(const DepthNoiseOptions& options, const draw::Intrinsics& intrinsics);

  /// `truth`: without noise. Returns the image of the camera; all randomness comes from `random`.
  draw::DepthImage apply(const draw::DepthImage& truth, math::Random random) const;

  /// Standard deviation along the optical axis of a surface seen from the front, m: noise and
  /// steps.
  double deviation(double z) const;

 private:
  struct Surroundings {
    double angle = 0;       // rad, between normal and viewing ray
    bool at_jump = false;   // one of the four neighbours belongs to another surface
    bool has_slope = true;  // not for surfaces that are one pixel wide, or seen edge-on
  };
  Surroundings look_around(const draw::DepthImage& truth, int column, int row) const;
  bool jumps(double z, double other) const;
  double displaced(const draw::DepthImage& truth, int column, int row, double angle,
                   math::Random& random) const;
  double quantised(double z) const;

  DepthNoiseOptions options_;
  draw::Intrinsics intrinsics_;
  double steepest_;  // relative change of depth between pixels of the same surface
};

}  // namespace palpate::camera
