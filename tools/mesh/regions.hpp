#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/mesh/region_selection.hpp"

namespace palpate::mesh_tool {

enum class RegionEdit { kReplace, kAdd, kRemove };

/// Sizes of a group, or of the whole mesh; nodes are corners of its faces and elements.
struct RegionSize {
  int nodes = 0, faces = 0, elements = 0;
  double area = 0;    // m^2, of the faces
  double volume = 0;  // m^3, of the elements
};

/// The named groups of a mesh, which the daemon's configuration names as clamp, grasps, surface and
/// parts of another stiffness, while they are changed. A group holds faces of the boundary,
/// elements, or both.
class Regions {
 public:
  using Groups = std::map<std::string, mesh::MeshGroup>;

  /// The elements must be positive, without errors of find_faults().
  explicit Regions(mesh::MeshWithGroups mesh);
  Regions(const Regions&) = delete;
  Regions& operator=(const Regions&) = delete;

  const mesh::MeshWithGroups& mesh() const { return mesh_; }
  const Groups& groups() const { return mesh_.groups; }
  /// Of an earlier state, to undo what was changed since.
  void set_groups(Groups groups) { mesh_.groups = std::move(groups); }
  /// The boundary's triangles, outward: a face is a column.
  const Eigen::Matrix3Xi& faces() const { return surface_.triangles; }
  const RegionSelection& selection() const { return selection_; }

  /// Faces or elements of a group, ascending; empty without such a group. A triangle of a group
  /// that is not of the boundary is no face.
  std::vector<int> members(const std::string& name, RegionKind kind) const;
  /// Faces of the boundary by which a group is seen from outside: its own and those of its
  /// elements. Ascending.
  std::vector<int> outer_faces(const std::string& name) const;
  /// What the group is made of: elements alone, otherwise faces.
  RegionKind kind_of(const std::string& name) const;
  /// Changes the faces or elements of a group. A group left with no node is removed. Throws
  /// std::invalid_argument, and changes nothing, if the name cannot be written to a file, if there
  /// are no members, or if there is no group to remove them from.
  void edit(const std::string& name, RegionKind kind, RegionEdit edit,
            const std::vector<int>& members);
  /// Throws std::invalid_argument if there is no such group.
  void erase(const std::string& name);

  RegionSize size(const std::string& name) const;
  RegionSize whole() const;
  /// Which of the groups clamp, grasp and second_grasp hold the same nodes, of which palpated
  /// accepts none; empty if none do.
  std::string conflict() const;
  /// The keys of palpated's section `object` that name groups of this mesh, once it is in `file`.
  std::string configuration(const std::string& file) const;

 private:
  const mesh::MeshGroup& group(const std::string& name) const;
  RegionSize size_of(const std::vector<int>& faces, const std::vector<int>& elements) const;

  mesh::MeshWithGroups mesh_;
  mesh::Surface surface_;
  RegionSelection selection_;
  std::map<mesh::Face, int> face_by_corners_;  // ascending corners
};

/// Whether the name is clamp, grasp or second_grasp.
bool is_held_region(const std::string& name);

/// The file can be read by palpated with the groups of faces and elements: .msh. Throws
/// std::runtime_error.
void check_region_file(const std::string& file);
/// Writes mesh and groups; with 10-node elements if the mesh has curved edges. Throws
/// std::runtime_error.
void write_regions(const Regions& regions, const std::string& file);

/// Red, green and blue, 0 to 1, by the group's name: clamp red, grasp green, second_grasp blue,
/// others in the order of their names.
std::map<std::string, Eigen::Vector3f> region_colours(const Regions::Groups& groups);

/// Draws the mesh with its groups in colours and a legend, from two sides, to a PNG. Throws
/// std::runtime_error if no image can be rendered.
void draw_regions(const Regions& regions, const std::string& title, const std::string& png);

}  // namespace palpate::mesh_tool
