#include "sim/camera/shape_camera.hpp"

namespace palpate::camera {

ShapeCamera::ShapeCamera(const ShapeCameraOptions& options)
    : options_(options), noise_(options.noise, camera_.intrinsics()) {}

ShapeReading ShapeCamera::look(const std::vector<Body>& bodies, math::Random random, int most) {
  DepthFrame frame = camera_.take(options_.X_WC, bodies);
  Mask mask;
  if (options_.segmentation == Segmentation::kTruth) mask = camera_.object_mask(frame, bodies);
  frame.depth = noise_.apply(frame.depth, random);
  if (options_.segmentation == Segmentation::kColour) mask = segment(frame, options_.filter);
  mask = without_margin(mask, frame.depth.width, options_.margin);

  const Eigen::Matrix3Xd seen_C = back_project(frame.depth, camera_.intrinsics(), mask);
  ShapeReading reading;
  const math::Pose X_WC = options_.X_WC * options_.calibration_error;
  const Eigen::Matrix3Xd seen_W = (X_WC.linear() * seen_C).colwise() + X_WC.translation();
  reading.points_W = thin_by_voxels(seen_W, options_.voxel, most);
  if (seen_C.cols() > 0) reading.deviation = noise_.deviation(seen_C.row(2).mean());
  return reading;
}

}  // namespace palpate::camera
