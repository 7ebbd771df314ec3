#pragma once

#include <memory>

#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {

inline constexpr draw::Colour kAmber{0.95F, 0.72F, 0.30F, 1};
inline constexpr draw::Colour kGrey{0.60F, 0.62F, 0.65F, 1};

inline Body body(draw::TriangleMesh mesh, const math::Pose& X_WB,
                 const draw::Colour& colour = kGrey, bool is_object = false) {
  return {std::make_shared<const draw::TriangleMesh>(std::move(mesh)), X_WB, colour, is_object};
}

inline math::Pose at(double x, double y, double z,
                     const Eigen::Vector3d& rotation = Eigen::Vector3d::Zero()) {
  return math::make_pose(math::exp_rotation(rotation), {x, y, z});
}

/// Camera at the origin of W, looking along x, its top towards z.
inline math::Pose camera_along_x() { return draw::look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}); }

}  // namespace palpate::camera
