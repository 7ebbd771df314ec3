#pragma once

#include <array>

#include "core/elasticity/deformation_model.hpp"
#include "core/math/rigid.hpp"

namespace palpate::estimation {

/// Two non-physical force patterns in the interior of the object, distributed along its longest
/// axis between fixed and held regions: one constant along the axis, one varying linearly from -1
/// to 1. Each acts on ten nodes near the axis with weights whose absolute values sum to at most 1.
/// They bend the shape as smoothly as an unknown body force and absorb model errors (mesh,
/// Poisson's ratio, inhomogeneous material), so that an observed shape can be matched without
/// residual error.
class VirtualLoads {
 public:
  static constexpr int kCount = 2;
  static constexpr int kStates = 3 * kCount;  // N, in O, one force vector per pattern
  using Forces = math::Vector6d;

  /// All patterns are zero if no node is free.
  explicit VirtualLoads(const elasticity::Body& body);

  /// Assigns the patterns to the first contact slots of the model; valid from its next
  /// factorisation on.
  void watch(elasticity::DeformationModel& model) const noexcept;
  static bool is_known(const elasticity::Sensitivity& sensitivity) noexcept;
  /// Forces, N, that displace some node by up to `distance`, m, in the most compliant direction.
  /// The same magnitude is used for the other directions, because the unknown load has no preferred
  /// direction: a plate is a hundred times stiffer in its plane than across it, and its model
  /// errors are smaller by the same factor. Zero along the longest axis: surface points do not
  /// observe sliding along the surface, and such loads would absorb other errors and drift by
  /// millimetres.
  Forces for_distance(double distance, const elasticity::Sensitivity& sensitivity) const noexcept;
  void add_to(Eigen::Matrix3Xd& loads, const Forces& forces) const noexcept;

 private:
  std::array<mesh::PointWeights, kCount> patterns_;
  int axis_ = 0;  // index of the longest axis
};

}  // namespace palpate::estimation
