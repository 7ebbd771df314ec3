#pragma once

#include <vector>

#include "sim/camera/depth_camera.hpp"

namespace palpate::scores {

/// The cloud that a camera without noise sees of a surface from X_WC: the thesis' virtual Kinect,
/// which renders the estimate from where the real one stood, so that a measured cloud, of one side
/// only, is compared with its like. 3 x n in W, m. `in_front`: what else stood there and hid parts
/// of it, such as the hand.
Eigen::Matrix3Xd virtual_cloud(camera::DepthCamera& camera, const math::Pose& X_WC,
                               const draw::TriangleMesh& surface_W,
                               const std::vector<camera::Body>& in_front = {});

}  // namespace palpate::scores
