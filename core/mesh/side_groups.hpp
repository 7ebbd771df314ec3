#pragma once

#include <functional>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Groups the boundary triangles of a mesh by the name that `name` returns for their corners
/// (columns, m); an empty name means no group. All tetrahedra become the group `body`.
void group_sides(MeshWithGroups& mesh,
                 const std::function<std::string(const Eigen::Matrix3d&)>& name);

}  // namespace palpate::mesh
