#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

/// How hard an element is strained.
enum class Strain {
  kStress,  // von Mises stress of its mean Cauchy stress, Pa, as in ElementStress
  kStretch  // largest principal stretch lambda_max(F) at its quadrature points, 1 at rest
};

/// One element's value and how it follows the element's nodes.
struct ElementStrain {
  static constexpr int kMostNodes = 10;
  using ByNode = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostNodes>;

  int element = -1;  // -1: none
  double value = 0;
  ByNode by_node;  // d value / d x of its nodes, in the order of the mesh; Pa/m or 1/m
};

/// Keeps the elements of a body that are strained most. Each look() evaluates those anew and,
/// beside them, the next kLook others in turn, so that its cost does not grow with the mesh; an
/// element that has become worse than one that is kept takes its place when its turn comes, that is
/// after at most elements / kLook looks. Nothing allocates after construction.
class WorstElements {
 public:
  static constexpr int kCount = 16;  // that are kept
  static constexpr int kLook = 16;   // others that one look() evaluates

  /// Throws std::invalid_argument where the body is not in order.
  WorstElements(const Body& body, Strain strain);

  /// At positions x (3 x n). An element keeps its place for as long as it is among the worst; where
  /// the body has fewer than kCount elements the last places stay empty.
  const std::array<ElementStrain, kCount>& look(const Eigen::Matrix3Xd& x) noexcept;

  /// Those of the last look.
  const std::array<ElementStrain, kCount>& kept() const noexcept { return worst_; }
  /// The largest value of the last look, 0 before the first.
  double peak() const noexcept;

  const mesh::ElementMesh& mesh() const noexcept { return elements_.mesh(); }

 private:
  struct Point {
    ElementStrain::ByNode gradients;                               // of the shape functions, 1/m
    double weight = 0;                                             // m^3
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // of the last look
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
