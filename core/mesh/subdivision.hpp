#pragma once

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh {

/// Divides each tetrahedron into eight of the same volume, whose corners are its own and the
/// middles of its edges: four at the corners, and four around the shortest diagonal of the
/// octahedron that remains. Tetrahedron t becomes 8 t to 8 t + 7. Nodes are those of the quadratic
/// mesh, in its order, so that those of `mesh` come first in either. Volumes differ where middles
/// are not those of straight edges.
TetrahedralMesh subdivide(const ElementMesh& quadratic);
TetrahedralMesh subdivide(const TetrahedralMesh& mesh);

}  // namespace palpate::mesh
