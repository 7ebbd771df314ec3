#include "tools/lab/scores/cloud_view.hpp"

#include "sim/camera/point_cloud.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::scores {

Eigen::Matrix3Xd virtual_cloud(camera::DepthCamera& camera, const math::Pose& X_WC,
                               const draw::TriangleMesh& surface_W,
                               const std::vector<camera::Body>& in_front) {
  std::vector<camera::Body> bodies = in_front;
  for (camera::Body& body : bodies) body.is_object = false;
  camera::Body object;
  object.mesh = std::make_shared<const draw::TriangleMesh>(surface_W);
  object.is_object = true;
  bodies.push_back(object);
  const camera::DepthFrame frame = camera.take(X_WC, bodies);
  const Eigen::Matrix3Xd cloud_C =
      camera::back_project(frame.depth, camera.intrinsics(), camera.object_mask(frame, bodies));
  return log::transformed(X_WC, cloud_C);
}

}  // namespace palpate::scores
