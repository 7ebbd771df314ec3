#pragma once

#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Treatment of elements without volume, by their numbers in the file.
struct FlatElements {
  std::vector<long> peeled;     // removed from the surface, where they covered others
  std::vector<long> inflated;   // given volume by moving interior nodes
  std::vector<long> collapsed;  // one of their edges was collapsed to a node
  std::vector<long> left;
};

/// Removes tetrahedra without volume (by the criterion of check()) such that the others remain
/// conforming and fill the same space. Other tetrahedra must be positively oriented.
FlatElements remove_flat_elements(MeshWithGroups& mesh);

}  // namespace palpate::mesh
