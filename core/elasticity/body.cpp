#include "core/elasticity/body.hpp"

#include <stdexcept>
#include <string>

#include "core/math/polar.hpp"

namespace palpate::elasticity {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument("body: " + message);
}

void check_material(const Material& material, const std::string& where) {
  require(material.young_modulus > 0 && std::isfinite(material.young_modulus),
          "Young's modulus" + where + " must be positive");
  require(material.poisson_ratio > -1 && material.poisson_ratio < 0.5,
          "Poisson's ratio" + where + " must lie between -1 and 0.5");
  require(material.density > 0 && std::isfinite(material.density),
          "density" + where + " must be positive");
}

}  // namespace

void Body::check() const {
  const int n = mesh.node_count();
  require(n > 0 && mesh.element_count() > 0, "the mesh is empty");
  require(mesh.nodes.allFinite(), "a node position is not finite");
  require(mesh.nodes_per_element() == (mesh.order == mesh::ElementOrder::kLinear ? 4 : 10),
          "elements do not have the nodes of their order");
  require(mesh.elements.minCoeff() >= 0 && mesh.elements.maxCoeff() < n,
          "an element names a node out of range");
  check_material(material, "");
  require(element_materials.empty() ||
              static_cast<int>(element_materials.size()) == mesh.element_count(),
          "there must be one material per element, or none");
  for (std::size_t e = 0; e < element_materials.size(); ++e) {
    check_material(element_materials[e], " of element " + std::to_string(e));
  }
  require(damping.mass_factor >= 0 && damping.stiffness_factor >= 0,
          "damping factors may not be negative");
  require(gravity_O.allFinite(), "gravity is not finite");
  require(grasps.size() <= 2, "at most two grasps");

  std::vector<bool> taken(n, false);
  for (int node : fixed_nodes) {
    require(node >= 0 && node < n, "fixed node " + std::to_string(node) + " is out of range");
    taken[node] = true;
  }
  for (const GraspRegion& grasp : grasps) {
    require(!grasp.nodes.empty(), "a grasp has no nodes");
    for (int node : grasp.nodes) {
      require(node >= 0 && node < n, "grasped node " + std::to_string(node) + " is out of range");
      require(!taken[node], "node " + std::to_string(node) + " is held twice");
      taken[node] = true;
    }
  }
}

std::vector<std::vector<int>> patches(const Body& body) {
  std::vector<std::vector<int>> nodes;
  for (const GraspRegion& grasp : body.grasps) nodes.push_back(grasp.nodes);
  return nodes;
}

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
