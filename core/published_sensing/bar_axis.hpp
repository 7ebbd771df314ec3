#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::published_sensing {

/// A bar as models of beams see it: a straight line that is clamped at one end.
struct BarAxis {
  int axis = 0;                                    // of O, along the bar
  double sign = 1;                                 // of s along that axis
  Eigen::Vector3d root = Eigen::Vector3d::Zero();  // m, middle of the clamped end
  double length = 0;                               // m
  double free_length = 0;                          // m, from the clamp to where the hand holds
  double area = 0;                                 // m^2, of the cross-section, a rectangle
  Eigen::Vector2d second_moment{0, 0};             // m^4, against bending towards across(0), (1)
  Eigen::VectorXd s;                               // m, of each mesh node, from the clamp
  Eigen::Matrix3Xd offset;                         // m, of each mesh node from the line, in O

  Eigen::Vector3d along() const { return sign * Eigen::Vector3d::Unit(axis); }
  Eigen::Vector3d across(int i) const { return Eigen::Vector3d::Unit((axis + 1 + i) % 3); }
};

/// Throws std::invalid_argument where the body is no bar: not thrice as long as wide, or not
/// clamped at one end of its longest side.
BarAxis find_bar_axis(const elasticity::Body& body);

}  // namespace palpate::published_sensing
