#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Sample point that represents a small area of the object's surface.
struct SurfaceSample {
  int index = 0;  // among all samples of the surface
  int face = 0;
  Eigen::Matrix<double, 9, 1> weights;                 // of the face's nodes; they sum to one
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // current position in O, m
  double area = 0;                                     // at rest, m^2
};

/// Ball in which samples are visited.
struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
  double radius = 0;                                 // m

  bool meets(const Box& box) const noexcept {
    const Eigen::Vector3d nearest = centre.cwiseMax(box.lower).cwiseMin(box.upper);
    return (centre - nearest).squaredNorm() <= radius * radius;
  }
  bool within(const Eigen::Vector3d& p, double margin) const noexcept {
    const double reach = radius + margin;
    return (p - centre).squaredNorm() <= reach * reach;
  }
};

/// The biquadratic surface of the object, sampled uniformly in small rest rectangles of one size
/// per face.
class ContactSurface {
 public:
  /// Places of the samples: at the midpoints of the rectangles, or at the Gauss points of pairs of
  /// them, with which a uniform pressure has exactly its consistent nodal forces.
  enum class Rule { kMidpoints, kGauss };

  ContactSurface() = default;

  /// Samples are at most `spacing` (m) apart at rest on average, at least four along each side of
  /// an element. Throws std::invalid_argument unless > 0.
  ContactSurface(const HexahedralGrid& grid, double spacing, Rule rule = Rule::kMidpoints);

  /// Calls visit(sample) for every sample in `zone`, which answers zone.meets(box), false only if
  /// the box lies outside, and zone.within(p, margin), whether p is at most `margin` (m) away from
  /// it. Complete as long as no line of the surface is stretched by more than kMostStretch.
  template <class Zone, class Visit>
  void for_each_in(const Zone& zone, const Eigen::Matrix3Xd& positions,
                   const Visit& visit) const noexcept;

  int sample_count() const { return sample_count_; }
  int face_count() const { return static_cast<int>(faces_.cols()); }
  int node(int face, int corner) const { return faces_(corner, face); }

  /// Upper bound of sum |weights|: the square of the Lebesgue constant of three equidistant nodes.
  static constexpr double kWeightSum = 1.5625;
  static constexpr double kMostStretch = 2;

 private:
  static constexpr int kCell =
      4;  // samples along a side of the squares that are skipped as a whole

  using Corners = Eigen::Matrix<double, 3, 9>;
  using Lines = std::vector<std::array<double, 3>>;  // shape functions of the nodes along one axis

  /// One side of an element.
  struct Side {
    Side(double length, double spacing, Rule rule);
    double apart;   // rest coordinates of the samples, m
    Lines samples;  // along it
    Lines cells;    // at the middle of each group of kCell samples
  };

  /// Quadratic curve across the face at a fixed v: its nodes' positions by column.
  static Eigen::Matrix3d line(const Corners& corners,
                              const std::array<double, 3>& along_v) noexcept {
    return along_v[0] * corners.leftCols<3>() + along_v[1] * corners.middleCols<3>(3) +
           along_v[2] * corners.rightCols<3>();
  }
  static Eigen::Vector3d along(const Eigen::Matrix3d& line,
                               const std::array<double, 3>& along_u) noexcept {
    return along_u[0] * line.col(0) + along_u[1] * line.col(1) + along_u[2] * line.col(2);
  }
  template <class Zone, class Visit>
  void visit_cell(const Zone& zone, const Corners& corners, int face, std::size_t cu,
                  std::size_t cv, const Visit& visit) const noexcept;
  /// Box that contains the face.
  static Box bounds(const Corners& corners) noexcept;

  Eigen::Matrix<int, 9, Eigen::Dynamic> faces_;
  std::vector<Side> sides_;                     // of the elements along x, then y, then z
  std::vector<std::array<int, 2>> face_sides_;  // of each face along u and v
  std::vector<int> first_samples_;              // of each face
  int sample_count_ = 0;
};

template <class Zone, class Visit>
void ContactSurface::visit_cell(const Zone& zone, const Corners& corners, int face, std::size_t cu,
                                std::size_t cv, const Visit& visit) const noexcept {
  const Side& side_u = sides_[face_sides_[face][0]];
  const Side& side_v = sides_[face_sides_[face][1]];
  const Lines& across_u = side_u.samples;
  const Lines& across_v = side_v.samples;
  SurfaceSample sample;
  sample.face = face;
  sample.area = side_u.apart * side_v.apart;
  for (std::size_t j = kCell * cv; j < kCell * (cv + 1); ++j) {
    const Eigen::Matrix3d curve = line(corners, across_v[j]);
    for (std::size_t i = kCell * cu; i < kCell * (cu + 1); ++i) {
      sample.position = along(curve, across_u[i]);
      if (!zone.within(sample.position, 0)) continue;
      sample.index = first_samples_[face] + static_cast<int>(i + across_u.size() * j);
      for (int b = 0; b < 9; ++b) sample.weights[b] = across_u[i][b % 3] * across_v[j][b / 3];
      visit(sample);
    }
  }
}

template <class Zone, class Visit>
void ContactSurface::for_each_in(const Zone& zone, const Eigen::Matrix3Xd& positions,
                                 const Visit& visit) const noexcept {
  for (int f = 0; f < face_count(); ++f) {
    Corners corners;
    for (int b = 0; b < 9; ++b) corners.col(b) = positions.col(faces_(b, f));
    if (!zone.meets(bounds(corners))) continue;
    const Side& side_u = sides_[face_sides_[f][0]];
    const Side& side_v = sides_[face_sides_[f][1]];
    const Lines& across_u = side_u.cells;
    const Lines& across_v = side_v.cells;
    const double cell_radius = 0.5 * kCell * std::hypot(side_u.apart, side_v.apart);
    for (std::size_t cv = 0; cv < across_v.size(); ++cv) {
      const Eigen::Matrix3d curve = line(corners, across_v[cv]);
      for (std::size_t cu = 0; cu < across_u.size(); ++cu) {
        if (zone.within(along(curve, across_u[cu]), kMostStretch * cell_radius))
          visit_cell(zone, corners, f, cu, cv, visit);
      }
    }
  }
}

}  // namespace palpate::object
