#pragma once

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Cuts the cells that are no tetrahedra: pyramids in two, prisms in three, hexahedra in twelve
/// about a new node in their middle. A rectangle is cut from its corner with the lowest number, so
/// that neighbours match. Returns how many cells were cut; one that names a node which is not
/// there stays. The new tetrahedra have the number of their cell and stand behind the others.
int split_cells(MeshWithGroups& mesh);

}  // namespace palpate::mesh
