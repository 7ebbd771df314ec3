#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::object {

/// Quadratic Lagrange polynomials with nodes -1, 0, 1 and their slopes at `xi`.
struct QuadraticShape {
  explicit QuadraticShape(double xi)
      : value{0.5 * xi * (xi - 1), 1 - xi * xi, 0.5 * xi * (xi + 1)},
        slope{xi - 0.5, -2 * xi, xi + 0.5} {}

  std::array<double, 3> value;
  std::array<double, 3> slope;
};

/// Share of a length associated with each of the three nodes (Gauss-Lobatto, i.e. Simpson).
inline constexpr std::array<double, 3> kLobattoShare{1.0 / 6, 4.0 / 6, 1.0 / 6};

/// Axis-aligned box in O, m; closed at both ends.
struct Box {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();

  /// True if `p` lies inside or within 1e-9 m of the box.
  bool contains(const Eigen::Vector3d& p) const;
};

/// A point of the rest shape as a weighted sum of the 27 nodes of its element.
struct MaterialPoint {
  std::array<int, 27> nodes{};
  std::array<double, 27> weights{};
  double outside = 0;  // m, distance of the point from the rest box; extrapolated if > 0

  /// Weighted sum of the columns of `values` (3 x node count: positions or velocities).
  Eigen::Vector3d interpolate(const Eigen::Matrix3Xd& values) const {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int a = 0; a < 27; ++a) p += weights[a] * values.col(nodes[a]);
    return p;
  }
};

/// A box divided along each axis into triquadratic hexahedra of 27 nodes.
///
/// Nodes form a grid of (2 elements + 1) per axis, x fastest, as do the elements. Within an element
/// node i + 3 j + 9 k lies at parent coordinates (i - 1, j - 1, k - 1), its parent box being [-1,
/// 1]^3.
class HexahedralGrid {
 public:
  /// Element borders along each axis, m from `origin`: from 0 to the length of the side.
  using Borders = std::array<std::vector<double>, 3>;

  /// Throws std::invalid_argument unless borders begin with 0 and ascend.
  HexahedralGrid(const Eigen::Vector3d& origin, const Borders& borders);

  int node_count() const { return static_cast<int>(nodes_.cols()); }
  int element_count() const { return static_cast<int>(elements_.cols()); }
  const Eigen::Matrix3Xd& nodes() const { return nodes_; }          // rest positions in O, m
  const Eigen::MatrixXi& elements() const { return elements_; }     // 27 x element count
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }  // surface, outward normals
  const Borders& borders() const { return borders_; }
  Eigen::Vector3d element_size(int element) const;  // sides at rest, m

  /// Index of the element along each axis.
  std::array<int, 3> cell(int element) const;

  /// Surface faces of 9 nodes, i + 3 j along both in-plane axes, ascending; their rest areas, m^2;
  /// and the axis normal to each.
  const Eigen::Matrix<int, 9, Eigen::Dynamic>& faces() const { return faces_; }
  const Eigen::VectorXd& face_areas() const { return face_areas_; }
  int face_axis(int face) const { return face_axes_[face]; }
  int face_element(int face) const { return face_elements_[face]; }

  /// Rest volume associated with each node, m^3: Gauss-Lobatto (Simpson) weights, all positive.
  Eigen::VectorXd nodal_volumes() const;

  /// Nodes whose rest position lies in the box, sorted.
  std::vector<int> nodes_in(const Box& box) const;

  /// Outward area vector associated with each node, m^2, of the faces that lie wholly in the box;
  /// if there is none, of every face, counted for the nodes in the box only. 0 elsewhere. With
  /// `only_axis` 0, 1 or 2 only faces normal to that axis count; -1: all.
  Eigen::Matrix3Xd patch_area_vectors(const Box& box, int only_axis = -1) const;

  /// The same as scalar areas: the areas of both faces at an edge add up.
  Eigen::VectorXd patch_areas(const Box& box, int only_axis = -1) const;

  /// Element and shape functions of a rest point in O.
  MaterialPoint locate(const Eigen::Vector3d& p_O) const;

 private:
  int node_index(int i, int j, int k) const { return i + points_[0] * (j + points_[1] * k); }
  void add_surface();
  void add_triangles(int face, bool upper);
  template <class Add>
  void for_each_patch_node(const Box& box, int only_axis, const Add& add) const;

  Eigen::Vector3d origin_;
  Borders borders_;
  Eigen::Vector3d size_;
  std::array<int, 3> counts_{};
  std::array<int, 3> points_{};
  Eigen::Matrix3Xd nodes_;
  Eigen::MatrixXi elements_;
  Eigen::Matrix3Xi triangles_;
  Eigen::Matrix<int, 9, Eigen::Dynamic> faces_;
  Eigen::VectorXd face_areas_;
  std::vector<int> face_axes_;
  std::vector<int> face_elements_;  // that they belong to
  std::vector<double> face_sides_;  // -1 or +1: direction of the outward normal along that axis
};

}  // namespace palpate::object
