#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::baselines {

/// Geometry of a bar for beam models: a straight line clamped at one end.
struct BarAxis {
  int axis = 0;                                    // axis of O along the bar
  double sign = 1;                                 // direction of s along that axis
  Eigen::Vector3d root = Eigen::Vector3d::Zero();  // m, centre of the clamped end
  double length = 0;                               // m
  double free_length = 0;                          // m, from the clamp to the grasp
  double area = 0;                                 // m^2, rectangular cross-section
  Eigen::Vector2d second_moment{0, 0};             // m^4, for bending towards across(0), (1)
  Eigen::VectorXd s;                               // m, arc length of each mesh node from the clamp
  /// m, offset of each mesh node from the line, in O
  Eigen::Matrix3Xd offset;

  Eigen::Vector3d along() const { return sign * Eigen::Vector3d::Unit(axis); }
  Eigen::Vector3d across(int i) const { return Eigen::Vector3d::Unit((axis + 1 + i) % 3); }
};

/// Throws std::invalid_argument if the body is not a bar, i.e. less than three times as long as
/// wide, or not clamped at one end of its longest side.
BarAxis find_bar_axis(const elasticity::Body& body);

}  // namespace palpate::baselines
