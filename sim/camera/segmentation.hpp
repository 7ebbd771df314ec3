#pragma once

#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {

/// How to find the object as a user of a real camera would: it lies in a known box and has a known
/// colour.
struct ObjectFilter {
  math::Pose X_WB = math::Pose::Identity();
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // of the box, m, in B
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  draw::Colour colour;
  double tolerance = 0.09;  // distance of chromaticities (shares of red, green, blue in their sum)
};

/// The pixels whose depth puts them into the box and whose chromaticity is that of the object,
/// whatever the light. Pixels that are almost black have no colour and are left out.
Mask segment(const DepthFrame& frame, const ObjectFilter& filter);

/// `mask` without the pixels that have one outside of it, or the picture's border, at most `margin`
/// columns and rows away: near an outline depth may be that of what lies behind.
Mask without_margin(const Mask& mask, int width, int margin);

}  // namespace palpate::camera
