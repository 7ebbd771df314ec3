#pragma once

#include <optional>
#include <vector>

#include "core/elasticity/stretch_law.hpp"
#include "core/math/rigid.hpp"
#include "core/mesh/element_mesh.hpp"

namespace palpate::elasticity {

/// Isotropic material; moduli at small strain.
struct Material {
  double young_modulus = 30e3;  // Pa, > 0
  double poisson_ratio = 0.3;   // in (-1, 0.5)
  double density = 26;          // kg/m^3, > 0
};

/// Rayleigh damping D = mass_factor M + stiffness_factor K of dynamic models.
struct Damping {
  double mass_factor = 1.0;        // 1/s
  double stiffness_factor = 0.01;  // s
};

/// Nodes that a hand can hold: while held they move with G as one rigid patch.
struct GraspRegion {
  std::vector<int> nodes;
  math::Pose X_OG_rest = math::Pose::Identity();  // pose of G in O in the rest state of the object
  /// Compliance of the pads: negative displacement (m, rad) of the object relative to the hand, in
  /// G, per wrench of the hand on it at the origin of G, in G; see pad_compliance(). Zero: rigid
  /// grasp.
  math::Matrix6d compliance = math::Matrix6d::Zero();
  /// Compliance of the object near the grasp that the model lacks. It is inversely proportional to
  /// Young's modulus, so that the resulting displacement does not depend on the modulus. See
  /// estimation::grasp_compliance.
  math::Matrix6d object_compliance = math::Matrix6d::Zero();
};

/// Deformable object; all quantities in its rest frame O.
struct Body {
  mesh::ElementMesh mesh;
  Material material;
  std::vector<Material> element_materials;  // one per element; empty: `material` everywhere
  std::optional<StretchLaw> law;            // at large strain; empty: linear and co-rotated
  Damping damping;
  std::vector<int> fixed_nodes;                         // nodes held by the test rig
  std::vector<GraspRegion> grasps;                      // at most two
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();  // m/s^2

  const Material& material_of(int element) const {
    return element_materials.empty() ? material : element_materials[element];
  }

  /// Throws std::invalid_argument naming the error (empty mesh, node out of range, a node both
  /// fixed and grasped, material out of range).
  void check() const;
};

/// Nodes of each grasp: the border groups of a pattern.
std::vector<std::vector<int>> patches(const Body& body);

/// Pose of G in O given by the node positions of a grasp, held or not: the least-squares rigid
/// motion. With fewer than three nodes: displacement only.
math::Pose grasp_pose(const Body& body, int grasp, const Eigen::Matrix3Xd& positions) noexcept;

}  // namespace palpate::elasticity
