#pragma once

#include <functional>
#include <vector>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh_tool {

/// What the members of a region are: triangles of the mesh's boundary, or tetrahedra.
enum class RegionKind { kFaces, kElements };

/// Part of space: whether a point, in m, belongs to it.
using Space = std::function<bool(const Eigen::Vector3d&)>;

// Closed, with a tolerance of 1e-9 m as for the boxes of palpated. Each throws
// std::invalid_argument for bounds in the wrong order, a radius that is not positive, or a
// direction of no length.
Space box_space(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
Space ball_space(const Eigen::Vector3d& centre, double radius);
/// Beyond the plane through `point`, in this direction.
Space half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& direction);

/// Finds the faces and elements of a mesh that belong to a place. Indices of faces are columns of
/// the boundary's triangles, those of elements tetrahedra; results ascend. Angles in radians.
class RegionSelection {
 public:
  /// `faces`: the boundary's triangles, outward. Both must outlive the object. Indices must be in
  /// range and coordinates finite.
  RegionSelection(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xi& faces);

  std::vector<int> all(RegionKind kind) const;
  /// Faces of which all corners lie in the space; elements whose centroid does, as in palpated.
  std::vector<int> inside(RegionKind kind, const Space& space) const;
  /// Faces whose outward normal is within `angle` of the direction.
  std::vector<int> facing(const Eigen::Vector3d& direction, double angle) const;
  /// Faces joined with face `start` by edges where the normals differ by at most `angle`; of all
  /// faces, or of those whose centroid lies in the space. Throws std::invalid_argument if there is
  /// no such face.
  std::vector<int> connected(int start, double angle) const;
  std::vector<int> connected(int start, double angle, const Space& space) const;
  /// Faces turned to the viewer of which all corners, by the perspective `clip_from_object` (4 x 4,
  /// of homogeneous coordinates), lie in the rectangle of normalised device coordinates; elements
  /// whose centroid does.
  std::vector<int> seen(RegionKind kind, const Eigen::Matrix4d& clip_from_object,
                        const Eigen::Vector2d& lower, const Eigen::Vector2d& upper) const;

  /// Elements that have one of these faces.
  std::vector<int> elements_at(const std::vector<int>& faces) const;
  /// With all that share a node with a member, `rounds` times.
  std::vector<int> grown(RegionKind kind, std::vector<int> members, int rounds) const;
  /// The face nearest to a point; the first of several.
  int nearest_face(const Eigen::Vector3d& point) const;

  double area(int face) const { return areas_[face]; }  // m^2
  Eigen::Vector3d normal(int face) const { return normals_.col(face); }

 private:
  Eigen::Vector3d face_centroid(int face) const;
  Eigen::Vector3d element_centroid(int element) const;

  const mesh::TetrahedralMesh& mesh_;
  const Eigen::Matrix3Xi& faces_;
  Eigen::Matrix3Xd normals_;  // outward, unit
  std::vector<double> areas_;
  Eigen::Matrix3Xi neighbours_;  // face beyond edges 01, 12, 20; -1: not exactly one
};

}  // namespace palpate::mesh_tool
