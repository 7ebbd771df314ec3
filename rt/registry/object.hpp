#pragma once

#include <string>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"
#include "rt/registry/frames.hpp"

namespace palpate::registry {

/// The object as the daemon believes it to be, from the section `object`.
struct Object {
  mesh::TetrahedralMesh corners;  // the linear mesh that SHAPE and SHAPE_MESH speak of
  std::int64_t hash = 0;
  elasticity::Body body;
  mesh::Surface surface;
};

/// Reads `object`: mesh (box or file), order, material (young_modulus, poisson_ratio, density),
/// material_file (of palpate-fit: its co-rotational constants, density and damping, as far as it
/// tells them, go over `material` and stand where `damping` says nothing), damping, fixed_box,
/// grasp_box, second_grasp_box, gravity. The rest pose of a grasp is `grasp_at_rest`
/// (`second_grasp_at_rest`) or the middle of the grasped nodes with the axes of O;
/// `grasp_stiffness` is that of its pads, N/m of the whole patch (absent: rigid). `remarks`: takes
/// a line for each bound of a box that lies between rows of the mesh's nodes; may be null. Throws
/// config::Error.
Object read_object(const config::Node& root, const Frames& frames,
                   std::vector<std::string>* remarks = nullptr);

}  // namespace palpate::registry
