#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// A point of the object's surface that stands for a bit of it.
struct SurfaceSample {
  int face = 0;
  Eigen::Matrix<double, 9, 1> weights;                 // of the face's nodes, adding up to one
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // now, in O, m
  double area = 0;                                     // at rest, m^2
};

/// The biquadratic surface of the object, sampled evenly at the midpoints of small rest rectangles.
class ContactSurface {
 public:
  ContactSurface() = default;

  /// Samples are at most `spacing` (m) apart at rest. Throws std::invalid_argument unless > 0.
  ContactSurface(const HexahedralGrid& grid, double spacing);

  /// Calls visit(sample) for every sample within `reach` of `centre`; some farther ones come along.
  /// Complete while no line of the surface is stretched by more than kMostStretch.
  template <class Visit>
  void for_each_near(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& centre, double reach,
                     const Visit& visit) const noexcept;

  int face_count() const { return static_cast<int>(faces_.cols()); }
  int node(int face, int corner) const { return faces_(corner, face); }

  /// sum |weights| is never more: the square of the Lebesgue constant of three even nodes.
  static constexpr double kWeightSum = 1.5625;
  static constexpr double kMostStretch = 3;

 private:
  static constexpr int kCell = 4;  // samples along a side of the squares that are passed over whole

  using Corners = Eigen::Matrix<double, 3, 9>;
  using Weights = Eigen::Matrix<double, 9, 1>;
  using Lines = std::vector<std::array<double, 3>>;  // shape functions of the nodes along one axis

  static Weights product(const std::array<double, 3>& along_u,
                         const std::array<double, 3>& along_v);
  bool may_touch(const Corners& corners, const Eigen::Vector3d& centre,
                 double reach) const noexcept;

  Eigen::Matrix<int, 9, Eigen::Dynamic> faces_;
  std::vector<int> axes_;                // that each face lies across
  std::array<Lines, 3> samples_;         // along each axis of an element
  std::array<Lines, 3> cells_;           // at the middle of every kCell of them
  std::array<double, 3> cell_radius_{};  // of a cell on faces across each axis, at rest, m
  std::array<double, 3> sample_area_{};  // m^2
};

inline ContactSurface::Weights ContactSurface::product(const std::array<double, 3>& along_u,
                                                       const std::array<double, 3>& along_v) {
  Weights weights;
  for (int b = 0; b < 9; ++b) weights[b] = along_u[b % 3] * along_v[b / 3];
  return weights;
}

template <class Visit>
void ContactSurface::for_each_near(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& centre,
                                   double reach, const Visit& visit) const noexcept {
  for (int f = 0; f < face_count(); ++f) {
    Corners corners;
    for (int b = 0; b < 9; ++b) corners.col(b) = positions.col(faces_(b, f));
    if (!may_touch(corners, centre, reach)) continue;
    const int axis = axes_[f];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    SurfaceSample sample;
    sample.face = f;
    sample.area = sample_area_[axis];
    const double cell_reach = reach + kMostStretch * cell_radius_[axis];
    for (std::size_t cv = 0; cv < cells_[v].size(); ++cv) {
      for (std::size_t cu = 0; cu < cells_[u].size(); ++cu) {
        const Eigen::Vector3d middle = corners * product(cells_[u][cu], cells_[v][cv]);
        if ((middle - centre).squaredNorm() > cell_reach * cell_reach) continue;
        for (int i = 0; i < kCell * kCell; ++i) {
          sample.weights =
              product(samples_[u][kCell * cu + i % kCell], samples_[v][kCell * cv + i / kCell]);
          sample.position = corners * sample.weights;
          visit(sample);
        }
      }
    }
  }
}

}  // namespace palpate::object
