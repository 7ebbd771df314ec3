#pragma once

#include "sim/camera/depth_camera.hpp"
#include "sim/camera/depth_noise.hpp"
#include "sim/camera/point_cloud.hpp"

namespace palpate::camera {

/// Segmentation parameters, as a user of a real camera would give them: a known box that contains
/// the object, and its known colour.
struct ObjectFilter {
  math::Pose X_WB = math::Pose::Identity();
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // of the box, m, in B
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  draw::Colour colour;
  double tolerance = 0.09;  // distance of chromaticities (shares of red, green, blue in their sum)
};

/// The pixels whose depth puts them into the box and whose chromaticity is that of the object,
/// regardless of brightness. Pixels that are almost black have no colour and are excluded.
Mask segment(const DepthFrame& frame, const ObjectFilter& filter);

/// `mask` without the pixels that are at most `margin` columns and rows away from an unset pixel or
/// the image border: near an outline the depth may be that of the background.
Mask without_margin(const Mask& mask, int width, int margin);

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
  ObjectFilter filter;    // for kColour
  int margin = 3;         // px, removed along the object's outline
  double voxel = 0.01;    // m, smallest side of the voxels that give one point each
  bool has_shape = true;  // whether readings contain the segmented object
  int cloud_stride = 0;   // px, between the pixels of the cloud of the whole view; 0: no cloud
};

/// Points on the visible surface of the object, and of the whole view.
struct ShapeReading {
  Eigen::Matrix3Xd points_W;  // m
  double deviation = 0;       // m, standard deviation of each coordinate
  ColouredCloud cloud_C;      // moved by the calibration error: a receiver that takes X_WC for the
                              // camera's pose errs as one does that believes X_WC error
};

/// A depth camera: noisy depth image, cloud of all that it shows; and the usual processing
/// by what only the simulator knows, the place or the pixels of the object: segmentation, thinning.
class ShapeCamera {
 public:
  /// Throws as DepthCamera and DepthNoise do.
  explicit ShapeCamera(const ShapeCameraOptions& options);

  /// The shape has at most `most` points. All randomness comes from `random`.
  ShapeReading look(const std::vector<Body>& bodies, math::Random random, int most);

 private:
  void add_shape(const DepthFrame& frame, Mask mask, int most, ShapeReading& reading) const;

  ShapeCameraOptions options_;
  DepthCamera camera_;
  DepthNoise noise_;
};

}  // namespace palpate::camera
