#pragma once

#include "sim/camera/depth_camera.hpp"

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

}  // namespace palpate::camera
