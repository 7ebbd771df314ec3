#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"
#include "rt/registry/box.hpp"
#include "rt/registry/frames.hpp"
#include "rt/registry/obstacles.hpp"
#include "rt/registry/regions.hpp"

namespace palpate::registry {

/// Model of the object, from the section `object`, and of its surroundings, from `obstacles`.
struct Object {
  mesh::TetrahedralMesh corners;  // linear mesh, whose nodes come first in the body's
  std::int64_t hash = 0;
  MeshGroups groups;  // of the mesh file
  elasticity::Body body;
  std::optional<double> largest_strain;  // principal, up to which the material's law holds
  mesh::Surface surface;
  std::vector<ConfiguredObstacle> obstacles;  // which it may meet, in O
  /// By hand: the space between its jaws, in G. None: the hand never opens.
  std::array<std::optional<Box>, 2> jaws;
};

/// Reads `object` and `obstacles`. Where `material_file` (of palpate-fit) has a constant, it
/// overrides `material`, and `damping` where that has no value. The rest pose of a grasp is
/// `grasp_at_rest`
/// (`second_grasp_at_rest`) or the centre of the grasped nodes with the axes of O. `remarks`
/// receives a line for each bound of a box that lies between rows of the mesh's nodes; may be null.
/// Throws config::Error.
Object read_object(const config::Node& root, const Frames& frames,
                   std::vector<std::string>* remarks = nullptr);

}  // namespace palpate::registry
