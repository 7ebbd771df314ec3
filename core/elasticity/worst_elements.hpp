#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

/// Measure of an element's strain.
enum class Strain {
  kStress,  // von Mises stress of its mean Cauchy stress, Pa, as in ElementStress
  kStretch  // largest principal stretch lambda_max(F) at its quadrature points, 1 at rest
};

/// Value of one element and its derivative with respect to the element's nodes.
struct ElementStrain {
  static constexpr int kMostNodes = 10;
  using ByNode = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostNodes>;

  int element = -1;  // -1: none
  double value = 0;
  ByNode by_node;  // d value / d x of its nodes, in mesh order; Pa/m or 1/m
};

/// Tracks the most strained elements of a body. Each look() evaluates these again and, in addition,
/// the next kLook others in turn, so that its cost does not grow with the mesh; an element that has
/// become worse than a tracked one replaces it when its turn comes, after at most elements / kLook
/// calls. Nothing allocates after construction.
class WorstElements {
 public:
  static constexpr int kCount = 16;  // number of tracked elements
  static constexpr int kLook = 16;   // number of others evaluated per look()

  /// Throws std::invalid_argument if the body is invalid.
  WorstElements(const Body& body, Strain strain);

  /// At positions x (3 x n). An element keeps its index in the array as long as it is among the
  /// worst; if the body has fewer than kCount elements, the last entries remain empty.
  const std::array<ElementStrain, kCount>& look(const Eigen::Matrix3Xd& x) noexcept;

  /// Result of the last look().
  const std::array<ElementStrain, kCount>& kept() const noexcept { return worst_; }
  /// Largest value of the last look(), 0 before the first.
  double peak() const noexcept;

  const mesh::ElementMesh& mesh() const noexcept { return elements_.mesh(); }

 private:
  struct Point {
    /// Gradients of the shape functions, 1/m.
    ElementStrain::ByNode gradients;
    double weight = 0;                                             // m^3
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // rotation at the last look()
  };
  void evaluate(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept;
  void evaluate_stress(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept;
  void evaluate_stretch(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept;
  Eigen::Matrix3d deformation(const Eigen::Matrix3Xd& x, int element,
                              const Point& point) const noexcept;
  Point* points_of(int element) noexcept { return &points_[element * points_per_element_]; }
  void take_in(const ElementStrain& candidate) noexcept;

  Strain strain_;
  ElementSet elements_;
  int points_per_element_ = 1;
  std::vector<Point> points_;
  std::vector<bool> kept_;  // by element
  std::array<ElementStrain, kCount> worst_;
  ElementStrain candidate_;
  int next_ = 0;
};

}  // namespace palpate::elasticity
