#pragma once

#include <vector>

#include "sim/camera/depth_camera.hpp"

namespace palpate::scores {

/// The cloud that a noise-free camera observes of a surface from X_WC: the thesis' virtual Kinect,
/// which renders the estimate from the pose of the real one, so that a measured one-sided cloud is
/// compared with a one-sided cloud. 3 x n in W, m. `in_front`: other bodies that occlude parts of
/// it, such as the hand.
Eigen::Matrix3Xd virtual_cloud(camera::DepthCamera& camera, const math::Pose& X_WC,
                               const draw::TriangleMesh& surface_W,
                               const std::vector<camera::Body>& in_front = {});

}  // namespace palpate::scores
