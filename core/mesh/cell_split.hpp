#pragma once

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Divides non-tetrahedral cells: pyramids into two tetrahedra, prisms into three, hexahedra into
/// twelve around a new node at their centre. A rectangle is divided at its corner with the lowest
/// number, so that neighbours match. Returns the number of divided cells; a cell with an invalid
/// node is unchanged. New tetrahedra have the number of their cell and are appended.
int split_cells(MeshWithGroups& mesh);

}  // namespace palpate::mesh
