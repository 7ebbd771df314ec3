#pragma once

#include "sim/camera/depth_noise.hpp"
#include "sim/camera/point_cloud.hpp"
#include "sim/camera/segmentation.hpp"

namespace palpate::camera {

enum class Segmentation {
  kColour,  // box of interest and colour, as with a real camera
  kTruth    // by the rendered body, known only to a simulator
};

struct ShapeCameraOptions {
  math::Pose X_WC = math::Pose::Identity();
  /// Error of the believed pose: points are reported as X_WC error p_C.
  math::Pose calibration_error = math::Pose::Identity();
  DepthNoiseOptions noise;
  Segmentation segmentation = Segmentation::kColour;
  ObjectFilter filter;  // for kColour
  int margin = 3;       // px, removed along the object's outline
  double voxel = 0.01;  // m, smallest side of the voxels that give one point each
};

/// Points on the visible surface of the object.
struct ShapeReading {
  Eigen::Matrix3Xd points_W;  // m
  double deviation = 0;       // m, standard deviation of each coordinate
};

/// A depth camera with the usual processing: noisy depth image, segmentation of the object, point
/// cloud, thinning.
class ShapeCamera {
 public:
  /// Throws as DepthCamera and DepthNoise do.
  explicit ShapeCamera(const ShapeCameraOptions& options);

  /// At most `most` points. All randomness comes from `random`.
  ShapeReading look(const std::vector<Body>& bodies, math::Random random, int most);

 private:
  ShapeCameraOptions options_;
  DepthCamera camera_;
  DepthNoise noise_;
};

}  // namespace palpate::camera
