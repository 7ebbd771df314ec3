#pragma once

#include <Eigen/Core>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Largest strain of a body: the largest magnitude of a principal strain (stretch minus 1) of an
/// element's mean deformation gradient. Each look() evaluates the next
/// kLook elements, so that its cost does not grow with the mesh. Nothing allocates after
/// construction.
class StrainScan {
 public:
  static constexpr int kLook = 16;

  /// Throws std::invalid_argument if the body is invalid.
  explicit StrainScan(const Body& body);

  /// At positions x (3 x n), m.
  void look(const Eigen::Matrix3Xd& x) noexcept;

  /// Of the last complete turn or of the elements seen since, whichever is larger; 0 before the
  /// first look().
  double largest() const noexcept { return now_ > last_ ? now_ : last_; }
  /// Forgets what was seen.
  void reset() noexcept;

 private:
  double strain_of(const Eigen::Matrix3Xd& x, int element) const noexcept;

  Eigen::MatrixXi elements_;     // nodes of each, by column
  Eigen::Matrix3Xd gradients_;   // mean gradient of each node's shape function, 1/m
  Eigen::Index node_count_ = 0;  // of the body
  int next_ = 0;
  double last_ = 0, now_ = 0;  // of the last complete turn, and of this one
};

}  // namespace palpate::elasticity
