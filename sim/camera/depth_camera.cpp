#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {

draw::Intrinsics KinectModel::intrinsics() {
  return {kFocalLength, kFocalLength, 0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
}

DepthCamera::DepthCamera(const draw::Intrinsics& intrinsics, int width, int height)
    : intrinsics_(intrinsics), renderer_(width, height) {}

void DepthCamera::draw(const std::vector<Body>& bodies, bool only_object) {
  for (const Body& body : bodies) {
    if (only_object && !body.is_object) continue;
    draw::MeshStyle style;
    style.colour = body.colour;
    const Eigen::Matrix3Xd points =
        (body.X_WB.linear() * body.mesh->points).colwise() + body.X_WB.translation();
    renderer_.draw_mesh(points, body.mesh->triangles, style);
  }
}

DepthFrame DepthCamera::take(const math::Pose& X_WC, const std::vector<Body>& bodies) {
  DepthFrame frame;
  frame.view.X_WC = X_WC;
  frame.view.intrinsics = intrinsics_;
  renderer_.begin(frame.view);
  draw(bodies, false);
  frame.colour = renderer_.end();
  frame.depth = renderer_.depth();
  return frame;
}

Mask DepthCamera::object_mask(const DepthFrame& frame, const std::vector<Body>& bodies) {
  renderer_.begin(frame.view);
  draw(bodies, true);
  renderer_.end();
  // Rendered alone, the object has bit-identical depth wherever nothing occludes it.
  const std::vector<float>& alone = renderer_.depth().metres;
  Mask mask(alone.size());
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = alone[i] > 0 && alone[i] == frame.depth.metres[i];
  return mask;
}

}  // namespace palpate::camera
