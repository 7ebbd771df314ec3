#pragma once

#include <functional>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Makes groups of a mesh's boundary triangles, each in the one that `name` calls by its corners
/// (columns, m); an empty name is none. All tetrahedra become the group `body`.
void group_sides(MeshWithGroups& mesh,
                 const std::function<std::string(const Eigen::Matrix3d&)>& name);

}  // namespace palpate::mesh
