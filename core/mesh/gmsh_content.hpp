#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Edges of a 10-node tetrahedron in Gmsh's order of their nodes.
inline constexpr int kGmshEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};

/// Number of nodes of an element of Gmsh's type; 0 if the type is unknown. The corners come first.
int gmsh_node_count(long type);
/// Type 4 or 11.
bool is_gmsh_tetrahedron(long type);

/// Content of a .msh file, collected element by element by the reader of the text or binary form.
/// Functions that return a string return an error message, empty on success.
class GmshContent {
 public:
  using Tag = std::pair<int, long>;  // dimension, number

  explicit GmshContent(OnFault on_fault) : on_fault_(on_fault) {}

  std::map<Tag, std::string> names;                // names of physical groups
  std::map<Tag, std::vector<long>> entity_groups;  // version 4: physical groups of each entity

  std::string add_node(long number, const Eigen::Vector3d& p);
  /// `nodes`: gmsh_node_count(type) numbers. Lines and points are ignored.
  std::string add_element(long number, long type, const std::vector<long>& nodes,
                          const std::vector<long>& groups);
  bool has_tetrahedra() const { return !tetrahedra_.empty(); }
  bool has_volume() const { return has_tetrahedra() || !others_.empty(); }

  MeshWithGroups assemble() const;

 private:
  struct Element {
    long number;
    std::array<long, 4> nodes;  // 3 or 4 node numbers of the file
    std::vector<long> groups;   // physical numbers
    std::vector<long> middles;  // nodes on the edges kGmshEdges of 10-node tetrahedra
  };
  struct Other {
    long number;
    std::vector<long> nodes;  // corners
  };

  std::map<long, int> numbered_nodes() const;
  void add_groups(const std::map<long, int>& index, MeshWithGroups& result) const;

  OnFault on_fault_;
  std::map<long, Eigen::Vector3d> nodes_;
  std::vector<Element> triangles_;
  std::vector<Element> tetrahedra_;
  std::vector<Other> others_;
  std::vector<long>
      flat_nodes_;  // nodes of triangles, lines and points, which a solid mesh may omit
};

}  // namespace palpate::mesh
