#pragma once

#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// What was done with elements without volume, by their numbers in the file.
struct FlatElements {
  std::vector<long> peeled;     // dropped from the surface, where they covered others
  std::vector<long> inflated;   // given volume by moving nodes inside
  std::vector<long> collapsed;  // one of their edges became a node
  std::vector<long> left;
};

/// Removes tetrahedra without volume (by check()'s bound) so that the others still match and fill
/// the same space. Tetrahedra with volume must be positive.
FlatElements remove_flat_elements(MeshWithGroups& mesh);

}  // namespace palpate::mesh
