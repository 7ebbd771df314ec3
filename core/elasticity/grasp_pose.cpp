#include "core/elasticity/grasp_pose.hpp"

#include "core/math/polar.hpp"

namespace palpate::elasticity {

math::Pose grasp_pose(const Body& body, int grasp, const Eigen::Matrix3Xd& positions) noexcept {
  const GraspRegion& region = body.grasps[grasp];
  const Eigen::Matrix3Xd& rest = body.mesh.nodes;
  const Eigen::Matrix3Xd& now = positions;
  if (region.nodes.empty()) return region.X_OG_rest;

  Eigen::Vector3d rest_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int node : region.nodes) {
    rest_centre += rest.col(node);
    centre += now.col(node);
  }
  rest_centre /= static_cast<double>(region.nodes.size());
  centre /= static_cast<double>(region.nodes.size());

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int node : region.nodes) {
    covariance += (now.col(node) - centre) * (rest.col(node) - rest_centre).transpose();
  }
  math::Pose motion = math::Pose::Identity();
  if (region.nodes.size() >= 3) motion.linear() = math::polar_rotation(covariance);
  motion.translation() = centre - motion.linear() * rest_centre;
  return motion * region.X_OG_rest;
}

}  // namespace palpate::elasticity
