#pragma once

#include <vector>

#include "core/math/rigid.hpp"
#include "core/mesh/element_mesh.hpp"

namespace palpate::elasticity {

/// Isotropic linear material of the co-rotational models.
struct Material {
  double young_modulus = 30e3;  // Pa, > 0
  double poisson_ratio = 0.3;   // in (-1, 0.5)
  double density = 26;          // kg/m^3, > 0
};

/// Rayleigh damping D = mass_factor M + stiffness_factor K, of dynamic models.
struct Damping {
  double mass_factor = 1.0;        // 1/s
  double stiffness_factor = 0.01;  // s
};

/// Nodes that a hand can hold: while held they move with G as one rigid patch.
struct GraspRegion {
  std::vector<int> nodes;
  math::Pose X_OG_rest = math::Pose::Identity();  // pose of G in O while the object is at rest
  /// How the object gives way in the hand: minus its motion in it (m, rad), in G, by the wrench of
  /// the hand on it at the origin of G, in G; see pad_compliance(). Zero: held firmly.
  math::Matrix6d compliance = math::Matrix6d::Zero();
  /// The same of the object beside the grasp, where the model is stiffer than it: falls with
  /// Young's modulus, so that what it gives by does not depend on that. See estimation::grasp_give.
  math::Matrix6d object_compliance = math::Matrix6d::Zero();
};

/// A deformable object, everything in its rest frame O.
struct Body {
  mesh::ElementMesh mesh;
  Material material;
  std::vector<Material> element_materials;  // one per element, or empty: `material` everywhere
  Damping damping;
  std::vector<int> fixed_nodes;                         // held by the test rig
  std::vector<GraspRegion> grasps;                      // at most two
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();  // m/s^2

  const Material& material_of(int element) const {
    return element_materials.empty() ? material : element_materials[element];
  }

  /// Throws std::invalid_argument naming what is wrong (empty mesh, node out of range, a node both
  /// fixed and grasped, material out of range).
  void check() const;
};

/// Nodes of each grasp: the border groups of a pattern.
std::vector<std::vector<int>> patches(const Body& body);

}  // namespace palpate::elasticity
