#include "sim/object/hexahedral_grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr double kBoxTolerance = 1e-9;  // m

}  // namespace

bool Box::contains(const Eigen::Vector3d& p) const {
  return (p.array() >= lower.array() - kBoxTolerance).all() &&
         (p.array() <= upper.array() + kBoxTolerance).all();
}

HexahedralGrid::HexahedralGrid(const Eigen::Vector3d& origin, const Borders& borders)
    : origin_(origin), borders_(borders) {
  if (!origin.allFinite()) throw std::invalid_argument("plant: the origin must be finite");
  std::array<std::vector<double>, 3> coordinates;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& cuts = borders_[axis];
    if (cuts.size() < 2 || cuts.front() != 0 || !std::isfinite(cuts.back())) {
      throw std::invalid_argument("plant: borders of elements begin with 0 and are two at least");
    }
    size_[axis] = cuts.back();
    counts_[axis] = static_cast<int>(cuts.size()) - 1;
    points_[axis] = 2 * counts_[axis] + 1;
    for (int i = 0; i < counts_[axis]; ++i) {
      if (!(cuts[i] < cuts[i + 1])) {
        throw std::invalid_argument("plant: borders of elements must ascend");
      }
      coordinates[axis].push_back(cuts[i]);
      coordinates[axis].push_back(0.5 * (cuts[i] + cuts[i + 1]));
    }
    coordinates[axis].push_back(cuts.back());
  }

  nodes_.resize(3, points_[0] * points_[1] * points_[2]);
  for (int k = 0; k < points_[2]; ++k) {
    for (int j = 0; j < points_[1]; ++j) {
      for (int i = 0; i < points_[0]; ++i) {
        nodes_.col(node_index(i, j, k)) =
            origin_ + Eigen::Vector3d(coordinates[0][i], coordinates[1][j], coordinates[2][k]);
      }
    }
  }

  elements_.resize(27, counts_[0] * counts_[1] * counts_[2]);
  for (int e = 0; e < element_count(); ++e) {
    const std::array<int, 3> at = cell(e);
    for (int a = 0; a < 27; ++a) {
      elements_(a, e) = node_index(2 * at[0] + a % 3, 2 * at[1] + a / 3 % 3, 2 * at[2] + a / 9);
    }
  }
  add_surface();
}

std::array<int, 3> HexahedralGrid::cell(int element) const {
  return {element % counts_[0], element / counts_[0] % counts_[1],
          element / (counts_[0] * counts_[1])};
}

Eigen::Vector3d HexahedralGrid::element_size(int element) const {
  const std::array<int, 3> at = cell(element);
  Eigen::Vector3d size;
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = borders_[axis][at[axis] + 1] - borders_[axis][at[axis]];
  return size;
}

void HexahedralGrid::add_surface() {
  const int face_count =
      2 * (counts_[0] * counts_[1] + counts_[1] * counts_[2] + counts_[2] * counts_[0]);
  faces_.resize(9, face_count);
  face_areas_.resize(face_count);
  triangles_.resize(3, 8 * face_count);
  int face = 0;
  for (int normal = 0; normal < 3; ++normal) {
    const int u = (normal + 1) % 3;
    const int v = (normal + 2) % 3;
    for (const bool upper : {false, true}) {
      for (int q = 0; q < counts_[v]; ++q) {
        for (int p = 0; p < counts_[u]; ++p, ++face) {
          std::array<int, 3> at{};
          for (int b = 0; b < 9; ++b) {
            at[normal] = upper ? points_[normal] - 1 : 0;
            at[u] = 2 * p + b % 3;
            at[v] = 2 * q + b / 3;
            faces_(b, face) = node_index(at[0], at[1], at[2]);
          }
          at[normal] = upper ? counts_[normal] - 1 : 0;
          at[u] = p;
          at[v] = q;
          face_elements_.push_back(at[0] + counts_[0] * (at[1] + counts_[1] * at[2]));
          const Eigen::Vector3d size = element_size(face_elements_.back());
          face_areas_[face] = size[u] * size[v];
          face_axes_.push_back(normal);
          face_sides_.push_back(upper ? 1 : -1);
          add_triangles(face, upper);
        }
      }
    }
  }
}

void HexahedralGrid::add_triangles(int face, bool upper) {
  int triangle = 8 * face;
  for (const int corner : {0, 1, 3, 4}) {
    const Eigen::Vector4i quad(faces_(corner, face), faces_(corner + 1, face),
                               faces_(corner + 4, face), faces_(corner + 3, face));
    // u x v points along +normal: the lower face is listed in reverse order.
    const Eigen::Vector4i ring = upper ? quad : Eigen::Vector4i(quad.reverse());
    triangles_.col(triangle++) = Eigen::Vector3i(ring[0], ring[1], ring[2]);
    triangles_.col(triangle++) = Eigen::Vector3i(ring[0], ring[2], ring[3]);
  }
}

Eigen::VectorXd HexahedralGrid::nodal_volumes() const {
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(node_count());
  for (int e = 0; e < element_count(); ++e) {
    const double element_volume = element_size(e).prod();
    for (int a = 0; a < 27; ++a) {
      volumes[elements_(a, e)] +=
          element_volume * kLobattoShare[a % 3] * kLobattoShare[a / 3 % 3] * kLobattoShare[a / 9];
    }
  }
  return volumes;
}

std::vector<int> HexahedralGrid::nodes_in(const Box& box) const {
  std::vector<int> found;
  for (int n = 0; n < node_count(); ++n) {
    if (box.contains(nodes_.col(n))) found.push_back(n);
  }
  return found;
}

template <class Add>
void HexahedralGrid::for_each_patch_node(const Box& box, int only_axis, const Add& add) const {
  const auto inside = [&](int node) { return box.contains(nodes_.col(node)); };
  const auto counts = [&](int face) { return only_axis < 0 || face_axes_[face] == only_axis; };
  const auto whole = [&](int face) {
    return counts(face) && std::all_of(faces_.col(face).begin(), faces_.col(face).end(), inside);
  };
  bool any_whole = false;
  for (int f = 0; f < faces_.cols(); ++f) any_whole = any_whole || whole(f);
  for (int f = 0; f < faces_.cols(); ++f) {
    if (!counts(f) || (any_whole && !whole(f))) continue;
    for (int b = 0; b < 9; ++b) {
      const double area = face_areas_[f] * kLobattoShare[b % 3] * kLobattoShare[b / 3];
      if (inside(faces_(b, f))) add(faces_(b, f), area, f);
    }
  }
}

Eigen::Matrix3Xd HexahedralGrid::patch_area_vectors(const Box& box, int only_axis) const {
  Eigen::Matrix3Xd vectors = Eigen::Matrix3Xd::Zero(3, node_count());
  for_each_patch_node(box, only_axis, [&](int node, double area, int face) {
    vectors(face_axes_[face], node) += face_sides_[face] * area;
  });
  return vectors;
}

Eigen::VectorXd HexahedralGrid::patch_areas(const Box& box, int only_axis) const {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(node_count());
  for_each_patch_node(box, only_axis, [&](int node, double area, int) { areas[node] += area; });
  return areas;
}

MaterialPoint HexahedralGrid::locate(const Eigen::Vector3d& p_O) const {
  MaterialPoint point;
  const Eigen::Vector3d p = p_O - origin_;
  point.outside = (p - p.cwiseMax(Eigen::Vector3d::Zero()).cwiseMin(size_)).norm();
  std::array<int, 3> at{};
  std::array<std::array<double, 3>, 3> shape{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& cuts = borders_[axis];
    const auto above = std::upper_bound(cuts.begin() + 1, cuts.end() - 1, p[axis]);
    at[axis] = static_cast<int>(above - cuts.begin()) - 1;
    const double length = *above - cuts[at[axis]];
    shape[axis] = QuadraticShape(2 * (p[axis] - cuts[at[axis]]) / length - 1).value;
  }
  const int e = at[0] + counts_[0] * (at[1] + counts_[1] * at[2]);
  for (int a = 0; a < 27; ++a) {
    point.nodes[a] = elements_(a, e);
    point.weights[a] = shape[0][a % 3] * shape[1][a / 3 % 3] * shape[2][a / 9];
  }
  return point;
}

}  // namespace palpate::object
