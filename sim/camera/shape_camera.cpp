#include "sim/camera/shape_camera.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace palpate::camera {
namespace {

constexpr double kDark = 45;  // sum of red, green and blue

bool same_colour(const std::uint8_t* pixel, const Eigen::Vector3d& chromaticity, double tolerance) {
  const Eigen::Vector3d rgb(pixel[0], pixel[1], pixel[2]);
  return rgb.sum() > kDark && (rgb / rgb.sum() - chromaticity).norm() <= tolerance;
}

}  // namespace

Mask segment(const DepthFrame& frame, const ObjectFilter& filter) {
  const Eigen::Vector3d rgb(filter.colour.red, filter.colour.green, filter.colour.blue);
  const Eigen::Vector3d chromaticity = rgb / rgb.sum();
  const math::Pose X_BC = filter.X_WB.inverse() * frame.view.X_WC;
  Mask mask(frame.depth.metres.size());
  std::size_t i = 0;
  for (int row = 0; row < frame.depth.height; ++row) {
    for (int column = 0; column < frame.depth.width; ++column, ++i) {
      const double z = frame.depth.metres[i];
      if (z == 0) continue;
      const Eigen::Vector3d p = X_BC * back_project(frame.view.intrinsics, column, row, z);
      const bool inside =
          (p.array() >= filter.lower.array()).all() && (p.array() <= filter.upper.array()).all();
      mask[i] =
          inside && same_colour(frame.colour.pixel(column, row), chromaticity, filter.tolerance);
    }
  }
  return mask;
}

Mask without_margin(const Mask& mask, int width, int margin) {
  const int height = static_cast<int>(mask.size()) / width;
  // Along rows, then along columns: a pixel is kept if the run of ones around it is long enough.
  const auto shrink = [margin](const Mask& from, int lines, int length, int line_step, int step) {
    Mask to(from.size());
    for (int line = 0; line < lines; ++line) {
      int run = 0;
      for (int i = 0; i < length; ++i) {
        const int pixel = line * line_step + i * step;
        run = from[pixel] ? run + 1 : 0;
        if (run > 2 * margin) to[pixel - margin * step] = 1;
      }
    }
    return to;
  };
  return shrink(shrink(mask, height, width, width, 1), width, height, 1, width);
}

ShapeCamera::ShapeCamera(const ShapeCameraOptions& options)
    : options_(options), noise_(options.noise, camera_.intrinsics()) {}

ShapeReading ShapeCamera::look(const std::vector<Body>& bodies, math::Random random, int most) {
  DepthFrame frame = camera_.take(options_.X_WC, bodies);
  Mask mask;
  if (options_.has_shape && options_.segmentation == Segmentation::kTruth)
    mask = camera_.object_mask(frame, bodies);
  frame.depth = noise_.apply(frame.depth, random);
  ShapeReading reading;
  if (options_.has_shape) add_shape(frame, std::move(mask), most, reading);
  if (options_.cloud_stride > 0) {
    reading.cloud_C = coloured_cloud(frame, options_.cloud_stride);
    const Eigen::Affine3f error(options_.calibration_error.cast<float>());
    reading.cloud_C.points = error * reading.cloud_C.points;
  }
  return reading;
}

void ShapeCamera::add_shape(const DepthFrame& frame, Mask mask, int most,
                            ShapeReading& reading) const {
  if (options_.segmentation == Segmentation::kColour) mask = segment(frame, options_.filter);
  mask = without_margin(mask, frame.depth.width, options_.margin);
  const Eigen::Matrix3Xd seen_C = back_project(frame.depth, camera_.intrinsics(), mask);
  const math::Pose X_WC = options_.X_WC * options_.calibration_error;
  const Eigen::Matrix3Xd seen_W = (X_WC.linear() * seen_C).colwise() + X_WC.translation();
  reading.points_W = thin_by_voxels(seen_W, options_.voxel, most);
  if (seen_C.cols() > 0) reading.deviation = noise_.deviation(seen_C.row(2).mean());
}

}  // namespace palpate::camera
