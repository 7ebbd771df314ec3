#pragma once

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"
#include "rt/component/frames.hpp"

namespace palpate::component {

/// The object as the daemon believes it to be, from the section `object`.
struct Object {
  mesh::TetrahedralMesh corners;  // the linear mesh that SHAPE and SHAPE_MESH speak of
  std::int64_t hash = 0;
  elasticity::Body body;
  mesh::Surface surface;
};

/// Reads `object`: mesh (box or file), order, material, damping, fixed_box, grasp_box,
/// second_grasp_box, gravity. The rest pose of a grasp is `grasp_at_rest` (`second_grasp_at_rest`)
/// or the middle of the grasped nodes with the axes of O. Throws config::Error.
Object read_object(const config::Node& root, const Frames& frames);

}  // namespace palpate::component
