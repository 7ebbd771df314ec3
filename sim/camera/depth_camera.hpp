#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/draw/renderer.hpp"

namespace palpate::camera {

/// A body that a camera may see.
struct Body {
  std::shared_ptr<const draw::TriangleMesh> mesh;  // in B
  math::Pose X_WB = math::Pose::Identity();
  draw::Colour colour;
  bool is_object = false;  // the body whose shape is measured
};

/// Which pixels, 1 or 0, rows from the top.
using Mask = std::vector<std::uint8_t>;

/// Images of a depth camera at one instant. Colour and depth are registered: the same pixel of both
/// shows the same point.
struct DepthFrame {
  draw::View view;
  draw::Image colour;
  draw::DepthImage depth;
};

/// Intrinsics of the first Kinect's 640 x 480 depth image: focal length 585 px (5.453 mm at 9.3 um
/// per pixel; Khoshelham and Elberink 2012), optical axis through the centre. Without lens
/// distortion.
struct KinectModel {
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;
  static constexpr double kFocalLength = 585;  // px
  static draw::Intrinsics intrinsics();
};

/// Depth and colour images of a scene from a pose, through OSMesa, without noise. Bodies in front
/// of the object occlude it. To be used by one thread at a time.
class DepthCamera {
 public:
  /// Throws std::runtime_error without OSMesa.
  explicit DepthCamera(const draw::Intrinsics& intrinsics = KinectModel::intrinsics(),
                       int width = KinectModel::kWidth, int height = KinectModel::kHeight);

  const draw::Intrinsics& intrinsics() const { return intrinsics_; }

  DepthFrame take(const math::Pose& X_WC, const std::vector<Body>& bodies);

  /// The pixels of `frame` that show the object: ground truth, unavailable to a real camera.
  /// `frame` must be the last one taken, of the same bodies.
  Mask object_mask(const DepthFrame& frame, const std::vector<Body>& bodies);

 private:
  void draw(const std::vector<Body>& bodies, bool only_object);

  draw::Intrinsics intrinsics_;
  draw::Renderer renderer_;
};

}  // namespace palpate::camera
