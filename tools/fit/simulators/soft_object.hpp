#pragma once

#include <string>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"
#include "rt/config/node.hpp"

namespace palpate::fit {

/// Behaviour of the grasped nodes in another simulator.
enum class ExportedGrasp {
  kFree,  // nothing holds them
  kHeld,  // they stay where they are at rest
};

struct ExportOptions {
  ExportedGrasp grasp = ExportedGrasp::kFree;
  int refinements = 0;  // divisions of each tetrahedron into eight, after those of quadratic ones
};

/// A configuration's object as other simulators represent it: linear tetrahedra in the base W.
struct SoftObject {
  std::string configuration;   // file
  mesh::TetrahedralMesh mesh;  // in W; the nodes of the daemon's mesh come first, in its order
  math::Pose X_WO = math::Pose::Identity();
  std::vector<elasticity::Material> materials;  // different ones
  std::vector<int> material_of;                 // by tetrahedron
  elasticity::Damping damping;
  std::vector<int> fixed;    // nodes that do not move, ascending; with those of a held grasp
  std::vector<int> grasped;  // nodes of all grasps, ascending
  Eigen::Vector3d gravity_W = Eigen::Vector3d::Zero();  // m/s^2
  /// Positions of the daemon's nodes under weight, in W, by co-rotational statics of its own
  /// elements, m.
  Eigen::Matrix3Xd at_rest;
  std::vector<std::string> left_out;  // what the files do not represent

  /// By node, kg: a quarter of each of its tetrahedra.
  Eigen::VectorXd masses() const;
  /// Displacement under weight of the daemon's node that moves farthest, m.
  Eigen::Vector3d largest_displacement() const;
  int farthest_node() const;
};

/// Reads a configuration of palpated. Quadratic elements are divided into eight linear ones, with
/// the same nodes. Throws config::Error, and std::runtime_error if the weight has no equilibrium.
SoftObject read_soft_object(const config::Node& configuration, const std::string& file,
                            const ExportOptions& options);

}  // namespace palpate::fit
